/// moodycamel::ConcurrentQueue, as it comes out of its package, with a producer token per worker:
/// without, what a worker pushes from two threads is in no order.
#pragma once

#include <concurrentqueue/concurrentqueue.h>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::checker {

template <class T>
class MoodycamelQueue {
 public:
  static constexpr std::string_view summary = "moodycamel::ConcurrentQueue, a token per worker";
  /// Its documentation: what goes in by one token comes out in order, and a pop may miss what is
  /// there.
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::library};

  MoodycamelQueue(unsigned workers, std::size_t capacity) : queue_(capacity) {
    for (unsigned i = 0; i < workers; ++i) tokens_.emplace_back(queue_);
  }

  bool push(unsigned worker, T task) { return queue_.enqueue(tokens_[worker], task); }
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_dequeue(task); }

 private:
  moodycamel::ConcurrentQueue<T> queue_;
  std::vector<moodycamel::ProducerToken> tokens_;
};

}  // namespace irt::checker
