/// MUTEX: a deque under one mutex, the null hypothesis.
///
/// When to use: always, until a measurement says otherwise. When not: when many threads spend a
/// visible share of their time here; then every operation waits for every other.
///
/// Ordering: FIFO in real time; the mutex puts all operations into one order. Progress: blocking.
/// Memory: blocks of the deque, returned as they empty. Unbounded.
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class MutexQueue {
 public:
  static constexpr std::string_view summary = "a deque under one mutex: the null hypothesis";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  MutexQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Adds `task` at the back. Blocking. Always true.
  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    return true;
  }

  /// Takes the oldest task; false if there is none. Blocking.
  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    if (tasks_.empty()) return false;
    task = tasks_.front();
    tasks_.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<T> tasks_;
};

}  // namespace irt
