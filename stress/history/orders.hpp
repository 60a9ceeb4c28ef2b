/// Judges a few calls by every order that they can have had (Wing and Gong 1993).
///
/// Exact where the oracles of long histories must be content with what is surely wrong: some order
/// of all calls that agrees with `precedes` must be one of a queue as claimed. What precedes what
/// is the caller's: happens-before, a clock, or both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stress/history/specification.hpp"
#include "stress/history/violation.hpp"

namespace irt::stress {

/// A call without stamps.
struct Call {
  Kind kind = Kind::push;
  unsigned worker = 0;
  Element value = 0;       ///< pushed or popped
  bool no_effect = false;  ///< it said so (no memory): its answer is right, and it was in flight
};

/// Finished calls and what precedes what among them.
class Calls {
 public:
  /// The first `before` calls precede each other and all others, in their order; the last `after`
  /// follow likewise. The others are ordered by `order`.
  Calls(std::vector<Call> calls, std::size_t before, std::size_t after);

  /// Says that call `a` precedes call `b`, both of those in the middle. Must be transitive, and
  /// agree with the order in which the calls stand.
  void order(std::size_t a, std::size_t b) {
    past_[b - before_][(a - before_) / 64] |= std::uint64_t{1} << (a - before_) % 64;
  }

  /// Says that nobody emptied the queue: what did not come out may be inside.
  void leave_inside() { emptied_ = false; }
  [[nodiscard]] bool emptied() const { return emptied_; }

  /// Says that call `i` had no effect, and that its answer is right.
  void excuse(std::size_t i) { calls_[i].no_effect = true; }
  /// Says that call `i` answered *empty*, as far as that is to be judged.
  void take_for_empty(std::size_t i) { calls_[i].kind = Kind::empty; }

  [[nodiscard]] bool precedes(std::size_t a, std::size_t b) const;
  [[nodiscard]] const std::vector<Call>& all() const { return calls_; }
  /// The calls in the middle are those in [begin, end).
  [[nodiscard]] std::size_t begin() const { return before_; }
  [[nodiscard]] std::size_t end() const { return calls_.size() - after_; }
  /// Those in the middle that precede the `i`-th of them, as bits.
  [[nodiscard]] const std::vector<std::uint64_t>& past(std::size_t i) const { return past_[i]; }

 private:
  std::vector<Call> calls_;
  std::size_t before_;
  std::size_t after_;
  std::vector<std::vector<std::uint64_t>> past_;
  bool emptied_ = true;
};

/// What is wrong, and with which calls: their numbers in `Calls::all()`, the one at fault first.
///
/// | pattern | calls |
/// |---|---|
/// | fresh | pop; its push, if somebody pushed that (later, or for another worker) |
/// | repeat | the second pop, the first, the push |
/// | lost | the push |
/// | order | two pops and their pushes, the wrong way round; none if it takes more to show it; |
/// | | for an element that stayed inside its push twice |
/// | full | the push that answered so |
/// | witness | the pop that answered *empty*, and a push and a pop if one element refutes it; |
/// | | none if several answers cannot all be true, though each could |
/// | closed | the push that was accepted, or the pop that waited, and the `close`; the pop that |
/// | | answered *closed* alone, or with a push and a pop (its push twice if it stayed inside) |
struct Breach {
  Pattern pattern = Pattern::fresh;
  std::vector<std::size_t> calls;
};

struct Judgement {
  std::optional<Breach> breach;
  /// False where there were too many orders to try them all: no breach then proves nothing.
  bool decided = true;
};

/// Judges calls of which the last ones emptied the queue, if `calls` says so. Tries at most
/// `most_states` states of calls made and elements held; time and memory grow with them.
Judgement judge_in_every_order(const Calls& calls, const Specification& specification,
                               std::size_t most_states = 1'000'000);

}  // namespace irt::stress
