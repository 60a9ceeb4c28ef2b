/// What closing a queue promises, for the few calls of a checker and for long histories.
///
/// - A push is not accepted once it follows a `close`.
/// - A waiting pop answers *closed* only if somebody has called `close`, and then this is the end:
///   no element that was accepted, before or since, comes out or is left behind by what follows.
///   Where *empty* may stand for calls in flight, a pop in flight excuses it.
/// - A waiting pop does not give up at its deadline if it follows a `close`.
///
/// A push that answered false and did not return before the first `close` was called was refused
/// for that and says nothing about places. Otherwise *closed* and giving up are *empty*, and judged
/// with the others. What follows what is told by happens-before; by the clock as well where the
/// queue claims to agree with it.
#pragma once

#include <optional>

#include "stress/history/operation.hpp"
#include "stress/history/orders.hpp"
#include "stress/history/specification.hpp"
#include "stress/history/violation.hpp"

namespace irt::stress {

/// The first rule that is broken; none if `calls` have nothing of the kind.
std::optional<Breach> judge_closing(const Calls& calls, const Specification& specification);
std::optional<Violation> judge_closing(const History& history, const Specification& specification);

/// The same with nothing that only closing explains: what the other judges know.
Calls without_closing(const Calls& calls);
/// None if `history` is that already.
std::optional<History> without_closing(const History& history);

}  // namespace irt::stress
