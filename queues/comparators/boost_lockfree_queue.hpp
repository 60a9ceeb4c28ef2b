/// Boost.Lockfree's `queue`: Michael and Scott's algorithm with counted pointers.
///
/// When to use: beside LFREE, to see what another way of reclaiming memory costs. When not: the
/// peak length matters, since nodes are kept for reuse and returned only at destruction.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator while the free
/// list is empty. Memory: a free list, `capacity` nodes at the start. Unbounded.
///
/// How it works: a pointer carries a 16-bit count in its unused bits, so a node that was used again
/// meanwhile makes a compare-and-swap fail; after exactly 65,536 reuses it would not. A pop may
/// read a task that is being overwritten and then discards it, which race detectors report.
#pragma once

#include <boost/lockfree/queue.hpp>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class BoostLockfreeQueue {
 public:
  static constexpr std::string_view summary = "Boost.Lockfree queue";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::free_list};

  BoostLockfreeQueue(unsigned /*workers*/, std::size_t capacity) : queue_(capacity) {}

  /// Adds `task`. Lock-free. Always true.
  bool push(unsigned /*worker*/, T task) { return queue_.push(task); }

  /// Takes a task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) {
    // The library may write to its argument and then answer false.
    T taken{};
    if (!queue_.pop(taken)) return false;
    task = taken;
    return true;
  }

 private:
  boost::lockfree::queue<T> queue_;
};

}  // namespace irt
