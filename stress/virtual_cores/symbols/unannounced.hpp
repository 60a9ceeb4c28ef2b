/// Accesses in the machine code of a module that no hook of -fsanitize=thread announces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace irt::symbols {

struct Unannounced {
  std::uint64_t address = 0;  ///< of the instruction, in the file
  std::string name;           ///< "mov"
  bool writes = false;
};

/// Reads and writes of memory other than the core's own stack and constants, to which no hook for
/// that address has been called since the last other call: compilers put the hook right before the
/// access and move neither across a call. `disassembly` is what `objdump -d --no-show-raw-insn`
/// prints, `sections` what `objdump -h -w` does.
///
/// Each function is interpreted once over values by name: registers and stack slots hold "what rdi
/// was at the beginning, plus 8", and where paths meet with different values, a new one. If
/// `results_on_stack` (the plug-in of GCC was there), what a function writes to the place for its
/// large result is on its caller's stack.
std::vector<Unannounced> unannounced(const std::vector<std::string>& disassembly,
                                     const std::vector<std::string>& sections);

}  // namespace irt::symbols
