/// What a module does that the checker does not see, and what that means.
#pragma once

#include <string>
#include <vector>

#include "stress/checker/program.hpp"

namespace irt::checker {

struct Unseen {
  std::vector<std::string> calls;         ///< of compiled code
  std::vector<std::string> instructions;  ///< that no hook announces, see Symbols
  std::string unproved{};                 ///< why a whole search is no proof; empty if it is one
  std::string refused{};                  ///< why it cannot be checked at all; empty if it can
};

/// Found once for each module.
const Unseen& unseen_of(virtual_cores::Module& module);

/// `limits` without what cannot be judged of this module: where compiled code or a store that no
/// hook announces may write, nobody knows what memory was not written.
Limits as_seen(Limits limits, virtual_cores::Module& module);

/// What of it is not seen, and that nothing is proved; empty if all is.
std::string words(const Unseen& unseen);

}  // namespace irt::checker
