/// A ring for one producer and one consumer whose order comes from fences: right by C++20, and
/// beyond ThreadSanitizer. And the same ring with a race that no fence covers.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

// GCC warns that ThreadSanitizer does not understand fences: that is what this is for.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wtsan"
#endif

namespace irt::stress {

template <bool racy>
struct Fenced {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a ring with fences";
    static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                   .push = Progress::wait_free,
                                   .pop = Progress::wait_free,
                                   .bounded = true,
                                   .producers = Callers::one,
                                   .consumers = Callers::one,
                                   .reclamation = Reclamation::preallocated};

    Queue(unsigned /*workers*/, std::size_t capacity) : slots_(capacity) {}

    bool push(unsigned /*worker*/, T task) {
      const std::size_t tail = tail_.load(std::memory_order_relaxed);
      if (tail - head_.load(std::memory_order_relaxed) >= slots_.size()) return false;
      // (1) acquire: with the load before it pairs with (4); the place is no longer read
      std::atomic_thread_fence(std::memory_order_acquire);
      slots_[tail % slots_.size()] = task;
      // (2) release: with the store after it pairs with (3)
      std::atomic_thread_fence(std::memory_order_release);
      tail_.store(tail + 1, std::memory_order_relaxed);
      if (racy) ++moved_;
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::size_t head = head_.load(std::memory_order_relaxed);
      if (head == tail_.load(std::memory_order_relaxed)) return false;
      // (3) acquire: with the load before it pairs with (2)
      std::atomic_thread_fence(std::memory_order_acquire);
      task = slots_[head % slots_.size()];
      // (4) release: with the store after it pairs with (1)
      std::atomic_thread_fence(std::memory_order_release);
      head_.store(head + 1, std::memory_order_relaxed);
      if (racy) ++moved_;
      return true;
    }

   private:
    std::vector<T> slots_;
    std::atomic<std::size_t> head_{0};
    std::atomic<std::size_t> tail_{0};
    std::size_t moved_ = 0;
  };
};

}  // namespace irt::stress

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
