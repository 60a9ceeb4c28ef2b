/// MUTEX: a deque under one mutex, the null hypothesis. Its waiting pop sleeps on a condition
/// variable.
///
/// When to use: always, until a measurement says otherwise. When not: when many threads spend a
/// visible share of their time here; then every operation waits for every other.
///
/// Ordering: FIFO in real time; the mutex puts all operations into one order. Progress: blocking.
/// Memory: blocks of the deque, returned as they empty. Unbounded.
#pragma once

#include <concepts>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <span>
#include <string_view>
#include <utility>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class MutexQueue {
 public:
  static constexpr std::string_view summary = "a deque under one mutex: the null hypothesis";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  MutexQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Adds `task` at the back; false once the queue is closed. Blocking.
  bool push(unsigned /*worker*/, T task) {
    std::unique_lock lock(mutex_);
    if (closed_) return false;
    tasks_.push_back(std::move(task));
    const bool wakes = waiting_ != 0;
    lock.unlock();
    if (wakes) changed_.notify_one();
    return true;
  }

  /// Takes the oldest task; false if there is none. Blocking.
  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    return take(task);
  }

  /// Takes the oldest task, waiting for one; false once the queue is closed and empty.
  bool pop_wait(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.wait(lock, [this] { return closed_ || !tasks_.empty(); });
    --waiting_;
    return take(task);
  }

  /// The same, until `deadline` at most.
  PopStatus pop_wait(unsigned /*worker*/, T& task, Deadline deadline) {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.wait_until(lock, deadline, [this] { return closed_ || !tasks_.empty(); });
    --waiting_;
    if (take(task)) return PopStatus::success;
    return closed_ ? PopStatus::closed : PopStatus::timed_out;
  }

  /// Refuses what is pushed from now on, and wakes whoever waits. Blocking.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  /// Adds all of `tasks` at once, or none once the queue is closed. Blocking.
  std::size_t push_bulk(unsigned /*worker*/, std::span<const T> tasks) requires std::copyable<T> {
    std::unique_lock lock(mutex_);
    if (closed_) return 0;
    for (const T& task : tasks) tasks_.push_back(task);
    const bool wakes = waiting_ != 0;
    lock.unlock();
    if (wakes) changed_.notify_all();
    return tasks.size();
  }

  /// Takes the oldest tasks at once, as many as there are. Blocking.
  std::size_t pop_bulk(unsigned /*worker*/, std::span<T> tasks) {
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    while (count < tasks.size() && take(tasks[count])) ++count;
    return count;
  }

 private:
  bool take(T& task) {
    if (tasks_.empty()) return false;
    task = std::move(tasks_.front());
    tasks_.pop_front();
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> tasks_;
  std::size_t waiting_ = 0;
  bool closed_ = false;
};

}  // namespace irt
