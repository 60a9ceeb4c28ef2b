/// `irt check test.cpp`, once the front door has built the program.
#pragma once

#include <string>

#include "stress/checker/program_check.hpp"

namespace irt::checker {

struct ProgramCommand {
  std::string module;   ///< made by irt_virtual_module() of sources with a `main`
  std::string command;  ///< how the user calls this again: "irt check test.cpp --threads 3"
  std::string replay;   ///< a schedule of an earlier report; empty: searches
  std::string dot_file;
  std::string json_file;
  std::string sarif_file;  ///< findings at their lines, for what shows them beside the source
  ProgramSettings settings;
};

/// Prints what comes of it; returns the exit code.
int run_program_command(const ProgramCommand& command);

}  // namespace irt::checker
