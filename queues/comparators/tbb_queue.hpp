/// oneTBB's `concurrent_queue`.
///
/// When to use: as the yardstick from a library that everyone can install. When not: a thread may
/// be stopped between taking its ticket and filling its slot; whoever wants that slot then waits.
///
/// Ordering: what the library documents, FIFO for each producer. Progress: blocking. Memory: pages
/// of the library's cache-aligned allocator. Unbounded.
///
/// How it works: a ticket counter at each end, dealt over eight lists of pages of slots.
#pragma once

#include <cstddef>
#include <oneapi/tbb/concurrent_queue.h>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class TbbQueue {
 public:
  static constexpr std::string_view summary = "oneTBB concurrent_queue";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .reclamation = Reclamation::library};

  TbbQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Adds `task`. Blocking. Always true.
  bool push(unsigned /*worker*/, T task) {
    queue_.push(task);
    return true;
  }

  /// Takes a task; false if it sees none. Blocking.
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_pop(task); }

 private:
  tbb::concurrent_queue<T> queue_;
};

}  // namespace irt
