/// Threads that push one and pop one, as often as they can, with and without counting.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/counted/atomic_events.hpp"
#include "queues/work_queue.hpp"

namespace irt {

struct PairsOptions {
  unsigned threads = 1;
  double seconds = 0.2;  ///< of one round of one build
  unsigned rounds = 5;
};

/// Each sample is one round: pushes and successful pops of all threads, divided by the time from
/// the common start to the common stop.
struct CountedPairs {
  std::vector<double> plain_per_second;
  std::vector<double> counted_per_second;
  std::uint64_t operations = 0;  ///< of all counted rounds: pushes and pops that succeeded
  std::uint64_t failed = 0;      ///< of all counted rounds: pops and pushes that did not
  AtomicEvents events;           ///< of all counted rounds
};

/// Runs `plain` and `counted` in turn, a fresh queue each time.
CountedPairs count_pairs(const QueueEntry& plain, const QueueEntry& counted,
                         const PairsOptions& options);

}  // namespace irt
