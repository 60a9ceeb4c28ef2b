/// A broken promise and the few operations that prove it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stress/history/operation.hpp"

namespace irt::stress {

/// What was broken. The first four patterns are those of Henzinger, Sezgin and Vafeiadis (2013):
/// a history of distinct elements is linearizable to a FIFO queue exactly if none occurs.
enum class Pattern : std::uint8_t {
  fresh,    ///< popped what nobody had pushed yet
  repeat,   ///< popped twice
  order,    ///< popped before an element that was pushed earlier
  witness,  ///< *empty* while an element was inside all the time
  lost,     ///< accepted, never popped, not found when the queue was drained
  full,     ///< *full* while fewer elements than the capacity were inside
  rank,     ///< overtook more elements than the relaxation allows
  closed,   ///< a rule of closing (closing.hpp)
};

/// The worker that stands for the drain in reports.
inline constexpr unsigned drain_worker = ~0U;

/// An operation and who made it.
struct Culprit {
  unsigned worker = 0;
  Operation operation;
};

/// One finding of an oracle.
struct Violation {
  Pattern pattern = Pattern::fresh;
  std::string text;  ///< one sentence
  std::vector<Culprit> culprits;
};

/// The promise that `pattern` breaks, in the words of the claims.
std::string_view promise(Pattern pattern);

/// An element for readers: producer and number, or the bare word when it is no known element.
std::string element_name(Element e);

/// The sentence, then one line per culprit with its interval drawn to scale:
///
///     worker 0  push 0:17   |---|               |  0 .. 120 ns
///     worker 1  pop  empty         |-----|      |  240 .. 480 ns
///
/// `ticks_per_nanosecond` turns stamps into time; 0 prints bare stamps.
std::string explain(const Violation& violation, double ticks_per_nanosecond);

}  // namespace irt::stress
