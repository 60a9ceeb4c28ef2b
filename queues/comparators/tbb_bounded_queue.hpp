/// oneTBB's `concurrent_bounded_queue`.
///
/// When to use: as `TbbQueue`, where memory must have a bound. When not: threads wait for each
/// other often, for a thread that pushes or pops may have to wake sleepers.
///
/// Ordering: what the library documents, FIFO for each producer. Progress: blocking. Memory: pages
/// of the library's cache-aligned allocator. Bounded.
///
/// How it works: the lists of pages of `TbbQueue`; tickets are given out only while they are less
/// than the capacity apart. The waiting forms of push and pop, which the contract has not, sleep on
/// monitors; the forms used here look whether anybody sleeps.
#pragma once

#include <cstddef>
#include <oneapi/tbb/concurrent_queue.h>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class TbbBoundedQueue {
 public:
  static constexpr std::string_view summary = "oneTBB concurrent_bounded_queue";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::library};

  TbbBoundedQueue(unsigned /*workers*/, std::size_t capacity) {
    queue_.set_capacity(static_cast<std::ptrdiff_t>(capacity));
  }

  /// Adds `task`; false if the queue is full. Blocking.
  bool push(unsigned /*worker*/, T task) { return queue_.try_push(task); }

  /// Takes a task; false if it sees none. Blocking.
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_pop(task); }

 private:
  tbb::concurrent_bounded_queue<T> queue_;
};

}  // namespace irt
