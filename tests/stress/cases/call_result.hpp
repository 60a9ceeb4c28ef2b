/// A ring for one producer and one consumer whose places are written by what a function returns:
/// GCC 12 does not announce such a write of a small class under -fsanitize=thread.
/// `CallResultFixed` is right and must not be accused of reading uninitialised memory;
/// `CallResultBug` publishes by a relaxed store: a data race on `value`, on `E|D` already.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
struct CallResultBox {
  T value;
};
template <class T>
[[gnu::noinline, gnu::noipa]] CallResultBox<T> call_result_box(T task) {
  return {task};
}

template <class T, std::memory_order publish>
class CallResultCase {
 public:
  static constexpr std::string_view summary = "a ring whose places are written by a call's result";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  CallResultCase(unsigned /*workers*/, std::size_t capacity)
      : size_(capacity + 1), places_(new CallResultBox<T>[size_]) {}  // not initialised, on purpose

  bool push(unsigned /*worker*/, T task) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) % size_;
    if (next == head_.load(std::memory_order_acquire)) return false;
    CallResultBox<T>& place = places_[tail];
    place = call_result_box(task);
    tail_.store(next, publish);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    task = places_[head].value;
    head_.store((head + 1) % size_, std::memory_order_release);
    return true;
  }

 private:
  std::size_t size_;
  std::unique_ptr<CallResultBox<T>[]> places_;
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
};

template <class T>
class CallResultBug : public CallResultCase<T, std::memory_order_relaxed> {
  using CallResultCase<T, std::memory_order_relaxed>::CallResultCase;
};
template <class T>
class CallResultFixed : public CallResultCase<T, std::memory_order_release> {
  using CallResultCase<T, std::memory_order_release>::CallResultCase;
};

}  // namespace irt
