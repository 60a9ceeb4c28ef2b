/// A program and what is wrong with it.
#pragma once

namespace irt::findings {

struct Program {
  const char* name;
  const char* finding;  ///< the name of the kind; empty for none
  void (*threads[3])();
  void (*prepare)() = nullptr;
  void (*finish)() = nullptr;  ///< with one, what is not freed is a leak
};

}  // namespace irt::findings
