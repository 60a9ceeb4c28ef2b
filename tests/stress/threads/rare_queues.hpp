/// Queues whose fault shows only in long runs, or after a failed allocation.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// A mutex; one element in 300,000 is lost, or else comes out a second time.
template <bool loses>
struct Rare {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a mutex and a rare defect";
    static constexpr Claims claims{.ordering = Ordering::unordered};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}
    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      const bool strikes = ++count_ % 300'000 == 0;
      if (!strikes || !loses) held_.push_back(task);
      if (strikes && !loses) held_.push_back(task);
      return true;
    }
    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      if (held_.empty()) return false;
      task = held_.front();
      held_.pop_front();
      return true;
    }

   private:
    std::mutex mutex_;
    std::deque<T> held_;
    std::uint64_t count_ = 0;
  };
};

/// A vector under a spinning lock that is full again and again; `keeps` leaves the lock locked when
/// there is no memory for a larger one.
template <bool keeps>
struct Growing {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a spin lock and a vector that grows";
    static constexpr Claims claims{.ordering = Ordering::unordered};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}
    bool push(unsigned /*worker*/, T task) {
      lock();
      try {
        held_.push_back(task);
      } catch (...) {
        if (!keeps) locked_.clear();
        throw;
      }
      locked_.clear();
      return true;
    }
    bool pop(unsigned /*worker*/, T& task) {
      lock();
      const bool found = !held_.empty();
      if (found) {
        task = held_.back();
        held_.pop_back();
      }
      locked_.clear();
      return found;
    }

   private:
    void lock() {
      while (locked_.test_and_set()) std::this_thread::yield();
    }
    std::atomic_flag locked_;
    std::vector<T> held_;
  };
};

}  // namespace irt::stress
