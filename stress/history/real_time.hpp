/// Judges a history by the clock: linearizability to a FIFO queue with exact *empty*, exact
/// *full*, and how far a relaxed queue strays.
///
/// a *precedes* b when a's interval, widened by the clock's error, ends before b's begins;
/// everything else counts as concurrent. Widening costs power, never justice.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "stress/history/matching.hpp"
#include "stress/history/specification.hpp"

namespace irt::stress {

/// The patterns *fresh* (popped before the push began), *order* and *witness* of Henzinger, Sezgin
/// and Vafeiadis, "Aspect-oriented linearizability proofs" (2013), found by sweeps over the merged
/// logs in O(n log n). With the exactly-once check of `Matching` the verdict is complete: a history
/// passes both if and only if it is linearizable (for runs that were drained).
///
/// *witness* only where *empty* is exact by the specification. Where *full* is, of a bounded queue:
/// illegal when at every moment of its interval fewer than the capacity can have been inside.
/// Necessary, not sufficient: it never accuses wrongly, it may miss.
std::vector<Violation> judge_real_time(const Matching& matching,
                                       const Specification& specification);

/// Distances over all popped elements; a distance counts only what the clock proves.
struct Distances {
  double mean = 0;
  std::uint64_t p99 = 0;
  std::uint64_t max = 0;
};
struct Relaxation {
  Distances rank_error;            ///< older elements still inside when an element left
  Distances overtaken;             ///< younger elements that left before an element
  std::optional<Violation> worst;  ///< the pop with the largest rank error
  /// Shares of the elements that were pushed and popped, by whose call *began* first, which
  /// linearizability leaves open: a FIFO queue has them, too ("Linearizability alone is not enough
  /// for strict FIFO semantics", ISPASS 2026).
  double pushes_overtaken = 0;  ///< left after one whose push had begun later
  double pops_overtaken = 0;    ///< were younger than what a pop got that had begun later
};

/// Measures relaxation in O(n log n).
Relaxation measure_relaxation(const Matching& matching);

/// A history in which every push has an element of its own, of logs of successful pushes and pops
/// where words are any, and one may be pushed again once it was popped. Every pop took what a push
/// of the logs brought.
History distinct(std::vector<std::vector<Operation>> logs, Stamp error);

}  // namespace irt::stress
