/// Queues for tests of the engine, right ones and wrong ones.
#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// A deque under a mutex.
template <class T>
class PlainQueue {
 public:
  static constexpr std::string_view summary = "test";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  PlainQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}
  bool push(unsigned /*worker*/, T task) {
    const std::scoped_lock lock(mutex_);
    tasks_.push_back(task);
    return true;
  }
  bool pop(unsigned /*worker*/, T& task) {
    const std::scoped_lock lock(mutex_);
    if (tasks_.empty()) return false;
    task = tasks_.front();
    tasks_.pop_front();
    return true;
  }

 protected:
  std::mutex mutex_;
  std::deque<T> tasks_;
};

inline constexpr QueueEntry plain_queue = queue_entry<PlainQueue>("plain");

/// One queue per worker, without any synchronisation: only the owner may touch it.
template <class T>
class OwnQueues {
 public:
  static constexpr std::string_view summary = "test";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .producers = Callers::own_worker,
                                 .consumers = Callers::own_worker};

  OwnQueues(unsigned workers, std::size_t /*capacity*/) : queues_(workers) {}
  bool push(unsigned worker, T task) {
    queues_[worker].push_back(task);
    return true;
  }
  bool pop(unsigned worker, T& task) {
    if (queues_[worker].empty()) return false;
    task = queues_[worker].front();
    queues_[worker].pop_front();
    return true;
  }

 private:
  std::vector<std::deque<T>> queues_;
};

/// A bounded queue that is nearly always full.
template <class T>
class TinyQueue : public PlainQueue<T> {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .bounded = true};
  using PlainQueue<T>::PlainQueue;
  bool push(unsigned /*worker*/, T task) {
    const std::scoped_lock lock(this->mutex_);
    if (this->tasks_.size() == 3) return false;
    this->tasks_.push_back(task);
    return true;
  }
};

/// One producer and one consumer at a time, without any synchronisation.
template <class T>
class SingleQueue {
 public:
  static constexpr std::string_view summary = "test";
  static constexpr Claims claims{
      .ordering = Ordering::fifo_real_time, .producers = Callers::one, .consumers = Callers::one};

  SingleQueue(unsigned /*workers*/, std::size_t capacity) : ring_(capacity) {}
  bool push(unsigned /*worker*/, T task) {
    const std::size_t at = pushed_.load(std::memory_order_relaxed);  // only producers write it
    if (at - popped_.load(std::memory_order_acquire) == ring_.size()) return false;
    ring_[at % ring_.size()] = task;
    pushed_.store(at + 1, std::memory_order_release);
    return true;
  }
  bool pop(unsigned /*worker*/, T& task) {
    const std::size_t at = popped_.load(std::memory_order_relaxed);  // only consumers write it
    if (at == pushed_.load(std::memory_order_acquire)) return false;
    task = ring_[at % ring_.size()];
    popped_.store(at + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> ring_;
  std::atomic<std::size_t> pushed_{0}, popped_{0};
};

/// Loses the fifth element that is pushed.
template <class T>
class LossyQueue : public PlainQueue<T> {
 public:
  using PlainQueue<T>::PlainQueue;
  bool push(unsigned worker, T task) {
    if (++pushed_ == 5) return true;
    return PlainQueue<T>::push(worker, task);
  }

 private:
  std::atomic<int> pushed_{0};
};

/// Hands the fifth element out twice, both times to the same worker.
template <class T>
class DoublingQueue : public PlainQueue<T> {
 public:
  using PlainQueue<T>::PlainQueue;
  bool pop(unsigned worker, T& task) {
    if (doubled_ && worker == victim_) {
      doubled_ = false;
      task = again_;
      return true;
    }
    if (!PlainQueue<T>::pop(worker, task)) return false;
    if (++popped_ == 5) {
      victim_ = worker;
      again_ = task;
      doubled_ = true;
    }
    return true;
  }

 private:
  std::atomic<int> popped_{0};
  std::atomic<bool> doubled_{false};
  std::atomic<unsigned> victim_{0};
  T again_{};
};

}  // namespace irt
