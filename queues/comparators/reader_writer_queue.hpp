/// Cameron Desrochers' `ReaderWriterQueue`.
///
/// When to use: exactly one thread pushes and one pops, and how much is inside has no bound. When
/// not: anybody else might.
///
/// Ordering: FIFO by happens-before. Progress: wait-free, apart from the allocator. Memory: blocks
/// that are kept for reuse and returned at destruction. Unbounded; `capacity` is a first helping.
///
/// How it works: a ring of blocks, each a ring with two counts that both sides remember. A producer
/// that finds the next block in use puts a new one between.
#pragma once

#include <cstddef>
#include <readerwriterqueue/readerwriterqueue.h>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class ReaderWriterQueue {
 public:
  static constexpr std::string_view summary = "cameron314 ReaderWriterQueue";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::free_list};

  ReaderWriterQueue(unsigned /*workers*/, std::size_t capacity) : queue_(capacity) {}

  /// Adds `task`. Wait-free. Always true.
  bool push(unsigned /*worker*/, T task) { return queue_.enqueue(task); }

  /// Takes the oldest task; false if it sees none. Wait-free.
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_dequeue(task); }

 private:
  moodycamel::ReaderWriterQueue<T> queue_;
};

}  // namespace irt
