/// Whole programs, each in a file of its own: programs/*.cpp and docs/programs/*.cpp. The first
/// line of each says what is to be found in it. All are compiled into one module, each in a
/// namespace (programs_probe.cpp, which CMake writes).
#pragma once

namespace irt::programs {

struct Entry {
  const char* name;
  const char* finds;  ///< a kind of finding, several joined by " | ", "nothing" or "not proved"
  int (*main)();
};

}  // namespace irt::programs
