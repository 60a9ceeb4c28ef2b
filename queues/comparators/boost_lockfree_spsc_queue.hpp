/// Boost.Lockfree's `spsc_queue`.
///
/// When to use: exactly one thread pushes and one pops, and Boost is there. When not: anybody else
/// might.
///
/// Ordering: FIFO by happens-before. Progress: wait-free. Memory: `capacity` places and one that
/// stays free, allocated once. Bounded.
///
/// How it works: a ring with an index for each side. Each call looks at both, which `SpscRing`
/// avoids by remembering.
#pragma once

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class BoostLockfreeSpscQueue {
 public:
  static constexpr std::string_view summary = "Boost.Lockfree spsc_queue";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  BoostLockfreeSpscQueue(unsigned /*workers*/, std::size_t capacity)
      : queue_(std::max<std::size_t>(capacity, 1)) {}

  /// Adds `task`; false if no place is free. Wait-free.
  bool push(unsigned /*worker*/, T task) { return queue_.push(task); }

  /// Takes the oldest task; false if it sees none. Wait-free.
  bool pop(unsigned /*worker*/, T& task) { return queue_.pop(task); }

 private:
  boost::lockfree::spsc_queue<T> queue_;
};

}  // namespace irt
