/// A ring for one producer and one consumer that keeps a mark beside each element. In the bug
/// nobody writes the mark before it is read.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool fixed>
class NeverWrittenCase {
 public:
  static constexpr std::string_view summary = "a ring with a mark beside each element";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  NeverWrittenCase(unsigned /*workers*/, std::size_t capacity)
      : size_(capacity + 1), places_(new Place[size_]) {}  // not initialised, on purpose

  bool push(unsigned /*worker*/, T task) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) % size_;
    if (next == head_.load(std::memory_order_acquire)) return false;
    places_[tail].value = task;
    if (fixed) places_[tail].mark = tail;
    tail_.store(next, std::memory_order_release);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    task = places_[head].value;
    marks_ += places_[head].mark;
    head_.store((head + 1) % size_, std::memory_order_release);
    return true;
  }

 private:
  struct Place {
    T value;
    std::uint64_t mark;
  };

  std::size_t size_;
  std::unique_ptr<Place[]> places_;
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
  std::uint64_t marks_ = 0;
};

template <class T>
class NeverWrittenBug : public NeverWrittenCase<T, false> {
  using NeverWrittenCase<T, false>::NeverWrittenCase;
};
template <class T>
class NeverWrittenFixed : public NeverWrittenCase<T, true> {
  using NeverWrittenCase<T, true>::NeverWrittenCase;
};

}  // namespace irt
