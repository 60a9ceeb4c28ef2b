/// From return addresses of a module to lines of its source, by DWARF, when a report is written.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::symbols {

struct Line {
  std::string function;
  std::string file;  ///< as the compiler was given it
  unsigned number = 0;
  std::string text;  ///< the line itself, without indentation; empty if it cannot be read
};

/// Whether the file belongs to the C++ library or to a test framework, so that whoever wrote the
/// test looks for the line that calls it.
bool is_foreign(const std::string& file);

/// Instructions that touch memory behind the checker's back.
struct UnseenInstructions {
  std::vector<std::string> places;  ///< "lock xadd at queue.hpp:12", each once
  std::size_t stores = 0;           ///< those of them that write
};

/// Asks addr2line(1), a process for each question: whoever has many addresses asks for all at once.
class Symbols {
 public:
  explicit Symbols(const virtual_cores::Module& module) : module_(module) {}

  /// Looks all of them up at once, for those who will ask for many.
  void look_up(const std::vector<const void*>& pcs);

  /// The line of the call before `pc`: the innermost one that is not the standard library's, or
  /// the innermost one if all are.
  const Line& at(const void* pc);

  /// "michael_scott_queue.hpp:84", or the bare address.
  std::string name(const void* pc);

  /// Those of the module, by objdump(1). They come from inline assembly, from intrinsics and from
  /// what the compiler does not announce.
  UnseenInstructions unseen_instructions();

 private:
  Line line_of(const std::vector<std::string>& frames);
  const virtual_cores::Module& module_;
  std::map<const void*, Line> lines_;
  std::map<std::string, std::vector<std::string>> sources_;
};

}  // namespace irt::symbols
