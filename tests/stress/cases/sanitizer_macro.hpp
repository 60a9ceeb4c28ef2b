/// A ring for one producer and one consumer that is right only where ThreadSanitizer's macro is
/// defined, as several libraries choose other code by it. What is shipped races: `irt check` must
/// say so.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class SanitizerMacroBug {
 public:
  static constexpr std::string_view summary = "right only under ThreadSanitizer";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};
#if defined(__SANITIZE_THREAD__)
  static constexpr std::memory_order publish = std::memory_order_release;
  static constexpr std::memory_order observe = std::memory_order_acquire;
#else
  static constexpr std::memory_order publish = std::memory_order_relaxed;
  static constexpr std::memory_order observe = std::memory_order_relaxed;
#endif

  SanitizerMacroBug(unsigned /*workers*/, std::size_t capacity) : places_(capacity + 1) {}

  bool push(unsigned /*worker*/, T task) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) % places_.size();
    if (next == head_.load(std::memory_order_acquire)) return false;
    places_[tail] = task;
    tail_.store(next, publish);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(observe)) return false;
    task = places_[head];
    head_.store((head + 1) % places_.size(), std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> places_;
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
};

}  // namespace irt
