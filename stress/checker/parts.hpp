/// One search by several processes at once.
///
/// The state of virtual cores is global to a process, so that each part is a forked child, which
/// sends back its result. What is found does not depend on who is first: of all findings the one
/// counts that its part made after the fewest executions, and of these the lowest part's.
#pragma once

#include "stress/checker/checker.hpp"

namespace irt::checker {

/// Processors that this process may use, at least 1.
unsigned processors();

/// Like `check`, with the work divided among `jobs` processes where it is worth that and can be
/// divided: all searches but the bounded one, when `options` take no part of the work already and
/// have no `each`. What a whole exhaustive search counts as complete, blocked and cut does not
/// depend on `jobs`. Throws std::runtime_error if a part crashes or does not come back.
Result check_in_parts(const Program& program, const Options& options, unsigned jobs);

}  // namespace irt::checker
