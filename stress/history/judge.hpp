/// One call: judge a history by what the queue claims.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/history/real_time.hpp"

namespace irt::stress {

/// What the oracles say of one history.
struct Verdict {
  std::vector<Violation> violations;  ///< broken claims; empty for a queue that kept its word
  std::uint64_t pushes = 0;
  std::uint64_t pops = 0;
  std::uint64_t empties = 0;
  std::uint64_t fulls = 0;
  /// Empties that happens-before refutes: a finding unless the claims let calls in flight, or
  /// others' finds, excuse them.
  std::uint64_t refuted_empties = 0;
  std::optional<Relaxation> relaxation;  ///< for queues that claim no FIFO over all elements
};

/// Judges `history`, made on a queue built with `capacity`, by what `claims` mean
/// (specification.hpp):
///
///     every queue          exactly once; the drain, if there was one, leaves nothing behind;
///                          *full* never without a bound; *empty* and *full* by happens-before
///                          the rules of closing (closing.hpp)
///     per_producer_fifo    order within a producer, by happens-before
///     k_relaxed_fifo       no pop passes more than k older elements, in real time
///     fifo_happens_before  order by happens-before
///     fifo_real_time       linearizable in real time, exact empty and full; implies the above
///
/// Where each worker has a queue of its own (`Callers::own_worker`), each is judged alone; the
/// relaxation is that of all together.
Verdict judge(const History& history, const Claims& claims, std::size_t capacity);

}  // namespace irt::stress
