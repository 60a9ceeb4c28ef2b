/// rust-embedded/heapless#207 (2021, 8 bits), dbittman/waitfree-mpsc-queue#11 (2021),
/// eclipse-iceoryx/iceoryx2#986 (2025, 32 bits): counters that wrap at a power of two, places by
/// remainder of a capacity that is none: after the wrap the places are others.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, class Index>
class NarrowIndexOf {
 public:
  static constexpr std::string_view summary = "SPSC ring, counter modulo capacity (heapless#207)";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  // A narrow counter cannot tell full from empty above its range: as the libraries, no more places.
  NarrowIndexOf(unsigned /*workers*/, std::size_t capacity)
      : slots_(std::clamp<std::size_t>(capacity, 1, std::numeric_limits<Index>::max())) {}

  bool push(unsigned /*worker*/, T task) {
    const Index tail = tail_.load(std::memory_order_relaxed);
    const Index head = head_.load(std::memory_order_acquire);
    if (static_cast<Index>(tail - head) == slots_.size()) return false;
    slots_[tail % slots_.size()] = task;
    tail_.store(static_cast<Index>(tail + 1), std::memory_order_release);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const Index head = head_.load(std::memory_order_relaxed);
    if (tail_.load(std::memory_order_acquire) == head) return false;
    task = slots_[head % slots_.size()];
    head_.store(static_cast<Index>(head + 1), std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> slots_;
  alignas(128) std::atomic<Index> head_{0};
  alignas(128) std::atomic<Index> tail_{0};
};

template <class T, bool Fixed>
class NarrowIndexCase
    : public NarrowIndexOf<T, std::conditional_t<Fixed, std::uint64_t, std::uint8_t>> {
  using NarrowIndexOf<T, std::conditional_t<Fixed, std::uint64_t, std::uint8_t>>::NarrowIndexOf;
};

template <class T>
class NarrowIndexBug : public NarrowIndexCase<T, false> {
  using NarrowIndexCase<T, false>::NarrowIndexCase;
};
template <class T>
class NarrowIndexFixed : public NarrowIndexCase<T, true> {
  using NarrowIndexCase<T, true>::NarrowIndexCase;
};
/// The same at the width of iceoryx2#986.
template <class T>
class NarrowIndex32Bug : public NarrowIndexOf<T, std::uint32_t> {
  using NarrowIndexOf<T, std::uint32_t>::NarrowIndexOf;
};
template <class T>
class NarrowIndex16Bug : public NarrowIndexOf<T, std::uint16_t> {
  using NarrowIndexOf<T, std::uint16_t>::NarrowIndexOf;
};

}  // namespace irt
