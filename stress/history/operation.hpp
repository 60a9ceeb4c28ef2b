/// What is written down about a run: one record per operation, one log per worker.
///
/// An element is a word that names its producer and its place in the producer's sequence, so that
/// every element of a run is distinct and per-producer order can be read off the words.
#pragma once

#include <cstdint>
#include <vector>

namespace irt::stress {

/// A moment, in the ticks of the clock that made it. `never` stands for the end of time.
using Stamp = std::uint64_t;
inline constexpr Stamp never = ~Stamp{0};

/// The elements that scenarios push.
using Element = std::uint64_t;
inline constexpr unsigned sequence_bits = 40;

/// The `sequence`-th element of `producer` (below 65,536), counted from 0.
constexpr Element element(unsigned producer, std::uint64_t sequence) {
  return (Element{producer} << sequence_bits) | sequence;
}
constexpr unsigned producer_of(Element e) {
  return static_cast<unsigned>(e >> sequence_bits);
}
constexpr std::uint64_t sequence_of(Element e) {
  return e & ((std::uint64_t{1} << sequence_bits) - 1);
}

/// What was called and what it answered.
enum class Kind : std::uint8_t {
  push,       ///< accepted
  full,       ///< a push that answered false
  pop,        ///< took `value`
  empty,      ///< a pop that answered false
  closed,     ///< a waiting pop that answered that the queue is closed and empty
  timed_out,  ///< a waiting pop that gave up at its deadline
  close,      ///< the queue was closed
  leave,      ///< the worker left
  meet,       ///< not an operation: the worker passed a barrier of all workers
};

/// One operation. Its effect took place somewhere in [invoked, returned].
struct Operation {
  Stamp invoked = 0;
  Stamp returned = 0;
  Element value = 0;  ///< the element pushed or popped; for `meet`, the number of the barrier
  Kind kind = Kind::push;
};

/// A finished run: what each worker did, in its own order, and what was left when all had stopped.
struct History {
  std::vector<std::vector<Operation>> logs;  ///< by worker
  std::vector<Operation> drain;              ///< pops made after every worker had stopped
  bool emptied = true;                       ///< by these, so that nothing stays inside
  /// A bound, in ticks, on how far a stamp may be from the true moment. Oracles widen every
  /// interval by it on both sides.
  Stamp error = 0;
};

}  // namespace irt::stress
