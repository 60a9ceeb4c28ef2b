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

/// A deque under a lock, with a bound. One defect: `loses_places` forgets a place now and then,
/// `loses_deep` an element where ten thousand are inside.
enum class Bounded { sound, loses_places, loses_deep };
template <Bounded kind>
struct WithBound {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a bounded deque under a lock";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .bounded = true};

    Queue(unsigned /*workers*/, std::size_t capacity) : places_(capacity) {}
    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      if (held_.size() >= places_) return false;
      if (kind != Bounded::loses_deep || held_.size() != 10'000) held_.push_back(task);
      return true;
    }
    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      if (held_.empty()) return false;
      task = held_.front();
      held_.pop_front();
      if (kind == Bounded::loses_places && ++popped_ % 50'000 == 0 && places_ > 1) --places_;
      return true;
    }

   private:
    std::mutex mutex_;
    std::deque<T> held_;
    std::size_t places_;
    std::uint64_t popped_ = 0;
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
