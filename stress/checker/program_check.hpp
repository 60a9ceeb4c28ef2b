/// What `irt check` does to a program: `main` and the threads that it begins, from its start to its
/// end, in every execution that there is time for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stress/checker/program_search.hpp"
#include "stress/checker/unseen.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::checker {

/// Threads that a program may have, the one of `main` included.
inline constexpr unsigned most_program_threads = max_threads - 1;

struct ProgramSettings {
  std::string name;                      ///< what the user calls it: "test.cpp"
  std::vector<std::string> arguments{};  ///< of `main`, without the name
  std::function<void()> work{};  ///< of the first thread, on its core; empty: the module's `main`
  unsigned (*failures)() = nullptr;  ///< assertions that have failed; of a test, see explore.hpp
  unsigned threads = 8;              ///< at most, the one of `main` included
  std::optional<Search> search{};    ///< none: exhaustive, then bounded and sampled
  double seconds = 50;               ///< for all searches together, at most
  bool unfreed = false;  ///< what is allocated where the program never frees anything leaks, too
  Conduct conduct{};
  Options options{};
};

/// What one search has come to.
struct SearchResult {
  std::string search;
  Result result{};
  std::string report{};                 ///< of the finding; empty if there is none
  std::string sentence{};               ///< of it
  std::vector<symbols::Line> places{};  ///< that the sentence speaks of
};

struct ProgramResult {
  std::vector<SearchResult> searches;
  Unseen unseen;
  bool found = false;
  bool whole = false;                    ///< every execution was looked at, ...
  bool proved = false;                   ///< ... nothing was found, and everything was seen
  bool differs = false;                  ///< executions differ where all choices are the same
  unsigned threads = 0;                  ///< that were begun in the execution that began most
  std::vector<std::string> never_freed;  ///< where it allocates what it loses: no finding
};

/// How to see a schedule again, in words or as a command.
using Again = std::function<std::string(const std::string& schedule)>;

/// Checks the program in `module`, made by irt_virtual_module() from sources with a `main`. Stops
/// at the first finding unless it is to keep going.
ProgramResult check_program(virtual_cores::Module& module, const ProgramSettings& settings,
                            const Again& again);

/// The whole in a few sentences: what was found or proved, and what was not, and why.
std::string verdict(const ProgramSettings& settings, const ProgramResult& result);

/// The report of what `schedule` does; empty if it finds nothing.
std::string replay(virtual_cores::Module& module, const ProgramSettings& settings,
                   const std::string& schedule, const std::string& dot_file);

}  // namespace irt::checker
