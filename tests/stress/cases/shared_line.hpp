/// aeron-io/aeron#1915 (2026), kin ubisoft/task-scheduler#15, yvanvds/yse-soundengine#296: padding
/// that does not separate what producers write from what consumers write.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool Fixed>
class SharedLineCase {
 public:
  static constexpr std::string_view summary =
      "ring with a turn per place, head and tail on one line (aeron#1915)";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated};

  SharedLineCase(unsigned /*workers*/, std::size_t capacity)
      : places_(std::bit_ceil(std::max<std::size_t>(capacity, 2))) {
    for (std::size_t i = 0; i < places_.size(); ++i) places_[i].turn.store(i);
  }

  bool push(unsigned /*worker*/, T task) {
    std::size_t ticket = tail_.load(std::memory_order_relaxed);
    for (;;) {
      Place& place = places_[ticket % places_.size()];
      const auto ahead =
          static_cast<std::int64_t>(place.turn.load(std::memory_order_acquire) - ticket);
      if (ahead < 0) return false;
      if (ahead > 0) {
        ticket = tail_.load(std::memory_order_relaxed);
      } else if (tail_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_relaxed)) {
        place.task = task;
        place.turn.store(ticket + 1, std::memory_order_release);
        return true;
      }
    }
  }

  bool pop(unsigned /*worker*/, T& task) {
    std::size_t ticket = head_.load(std::memory_order_relaxed);
    for (;;) {
      Place& place = places_[ticket % places_.size()];
      const auto ahead =
          static_cast<std::int64_t>(place.turn.load(std::memory_order_acquire) - ticket - 1);
      if (ahead < 0) return false;
      if (ahead > 0) {
        ticket = head_.load(std::memory_order_relaxed);
      } else if (head_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_relaxed)) {
        task = place.task;
        place.turn.store(ticket + places_.size(), std::memory_order_release);
        return true;
      }
    }
  }

 private:
  static constexpr std::size_t apart = Fixed ? 128 : alignof(std::size_t);
  static constexpr std::size_t place_apart = Fixed ? 128 : alignof(std::size_t);
  struct alignas(place_apart) Place {
    std::atomic<std::size_t> turn{0};
    T task{};
  };
  std::vector<Place> places_;
  alignas(apart) std::atomic<std::size_t> head_{0};
  alignas(apart) std::atomic<std::size_t> tail_{0};
};

template <class T>
class SharedLineBug : public SharedLineCase<T, false> {
  using SharedLineCase<T, false>::SharedLineCase;
};
template <class T>
class SharedLineFixed : public SharedLineCase<T, true> {
  using SharedLineCase<T, true>::SharedLineCase;
};

}  // namespace irt
