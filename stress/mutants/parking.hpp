/// Queues with a `pop_wait`, and lost wake-ups.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/blocking/closing.hpp"
#include "queues/work_queue.hpp"

namespace irt::stress {

enum class ParkingBug {
  none,
  if_not_while,     ///< M20: the condition is not looked at again after the wait
  only_transition,  ///< M21: only the push that ends emptiness notifies, and only one
  silent_close,     ///< M25: closing does not wake who is parked
};

template <ParkingBug bug>
struct Parking {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a mutex and a condition variable; pop parks";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      std::unique_lock lock(mutex_);
      if (closed_) return false;
      const bool was_empty = held_.empty();
      held_.push_back(task);
      lock.unlock();
      if (bug != ParkingBug::only_transition || was_empty) changed_.notify_one();
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      return take(task);
    }

    bool pop_wait(unsigned /*worker*/, T& task) {
      std::unique_lock lock(mutex_);
      if (bug == ParkingBug::if_not_while) {
        if (held_.empty() && !closed_) changed_.wait(lock);
      } else {
        while (held_.empty() && !closed_) changed_.wait(lock);
      }
      return take(task);
    }

    void close() {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      if (bug != ParkingBug::silent_close) changed_.notify_all();
    }

   private:
    bool take(T& task) {
      if (held_.empty()) return false;
      task = held_.front();
      held_.pop_front();
      return true;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<T> held_;
    bool closed_ = false;
  };
};

/// One producer, one consumer, a ring, and an event count for the parked consumer. `ordered` is the
/// healthy twin. M23: the producer's look at the number of waiters may overtake its publication.
template <bool ordered>
struct EventCounted {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a ring and an event count; pop parks";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .bounded = true,
                                   .producers = Callers::one,
                                   .consumers = Callers::one,
                                   .reclamation = Reclamation::preallocated};

    Queue(unsigned workers, std::size_t capacity) : slots_(capacity), closing_(workers) {}

    bool push(unsigned worker, T task) {
      return closing_.push(worker, [&] { return push_while_open(task); });
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::size_t head = head_.load(std::memory_order_relaxed);
      if (tail_.load() == head) return false;
      task = slots_[head % slots_.size()];
      head_.store(head + 1);
      return true;
    }

    bool pop_wait(unsigned worker, T& task) {
      const std::size_t head = head_.load(std::memory_order_relaxed);
      if (tail_.load() == head) {
        std::unique_lock lock(mutex_);
        ++waiters_;
        while (tail_.load() == head && !closing_.closed()) changed_.wait(lock);
        --waiters_;
        lock.unlock();
        if (closing_.closed()) closing_.wait_for_pushes();
      }
      return pop(worker, task);
    }

    void close() {
      const std::lock_guard lock(mutex_);
      closing_.close();
      changed_.notify_all();
    }

   private:
    bool push_while_open(T task) {
      const std::size_t tail = tail_.load(std::memory_order_relaxed);
      if (tail - head_.load() == slots_.size()) return false;
      slots_[tail % slots_.size()] = task;
      constexpr auto publish = ordered ? std::memory_order_seq_cst : std::memory_order_release;
      constexpr auto look = ordered ? std::memory_order_seq_cst : std::memory_order_relaxed;
      tail_.store(tail + 1, publish);
      if (waiters_.load(look) > 0) {
        const std::lock_guard lock(mutex_);
        changed_.notify_one();
      }
      return true;
    }

    std::vector<T> slots_;
    alignas(128) std::atomic<std::size_t> head_{0};
    alignas(128) std::atomic<std::size_t> tail_{0};
    alignas(128) std::atomic<unsigned> waiters_{0};
    std::mutex mutex_;
    std::condition_variable changed_;
    Closing closing_;
  };
};

/// A pool for frames: `pop` waits for a task and answers false when the frame is over, that is when
/// no task is inside or being worked on. `counts_work` is the healthy twin. M46: a task counts as
/// done when it is taken, so a worker may leave while another is about to add children.
template <bool counts_work>
struct FramePool {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary =
        "a lock and a count of tasks; pop waits for the frame";
    static constexpr Claims claims{.ordering = Ordering::unordered};

    Queue(unsigned workers, std::size_t /*capacity*/) : busy_(workers) {}

    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      ++unfinished_;
      held_.push_back(task);
      return true;
    }

    bool pop(unsigned worker, T& task) {
      std::unique_lock lock(mutex_);
      if (busy_[worker]) {
        busy_[worker] = false;
        --unfinished_;
      }
      while (held_.empty() && unfinished_ > 0) {
        lock.unlock();
        lock.lock();
      }
      if (held_.empty()) return false;
      task = held_.front();
      held_.pop_front();
      if (counts_work) {
        busy_[worker] = true;
      } else {
        --unfinished_;
      }
      return true;
    }

   private:
    std::mutex mutex_;
    std::deque<T> held_;
    std::vector<bool> busy_;  // under the lock
    std::uint64_t unfinished_ = 0;
  };
};

}  // namespace irt::stress
