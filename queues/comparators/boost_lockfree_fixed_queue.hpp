/// Boost.Lockfree's `queue` of fixed size.
///
/// When to use: as `BoostLockfreeQueue`, where nothing may be allocated while the queue is in use.
/// When not: more than 65,534 elements must fit. This is the library's limit, and the one place
/// where a capacity that was asked for is not kept: it is cut down to that.
///
/// Ordering: FIFO by happens-before. Progress: lock-free. Memory: `capacity` nodes, allocated once.
/// Bounded; *full* counts the nodes of pushes and pops in flight, which take theirs first and give
/// it back last.
///
/// How it works: as `BoostLockfreeQueue`, with indices into an array of nodes in place of pointers;
/// an index and its 16-bit count fit into four bytes.
#pragma once

#include <algorithm>
#include <boost/lockfree/queue.hpp>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class BoostLockfreeFixedQueue {
 public:
  static constexpr std::string_view summary = "Boost.Lockfree queue of fixed size";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .full = Answer::calls_in_flight,
                                 .reclamation = Reclamation::preallocated};

  BoostLockfreeFixedQueue(unsigned /*workers*/, std::size_t capacity)
      : queue_(std::min<std::size_t>(capacity, 65'534)) {}

  /// Adds `task`; false if no node is free. Lock-free.
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
  boost::lockfree::queue<T, boost::lockfree::fixed_sized<true>> queue_;
};

}  // namespace irt
