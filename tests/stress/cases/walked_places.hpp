/// A ring whose pop walks over all places, again and again while a count says that something is
/// inside. The count is relaxed, so a walk may see the newest count beside an old place; another
/// walk sees the place, for what is stored becomes visible in the end.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class WalkedPlaces {
 public:
  static constexpr std::string_view summary = "a bag of places that pops walk over";
  static constexpr Claims claims{
      .bounded = true, .producers = Callers::one, .consumers = Callers::one};

  WalkedPlaces(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 2)) {}

  bool push(unsigned /*worker*/, T task) {
    for (Place& place : places_) {
      if (place.full.load(std::memory_order_acquire)) continue;
      place.task = task;
      place.full.store(true, std::memory_order_release);
      count_.fetch_add(1, std::memory_order_relaxed);
      return true;
    }
    return false;
  }

  bool pop(unsigned /*worker*/, T& task) {
    while (count_.load(std::memory_order_relaxed) > 0) {
      for (Place& place : places_) {
        if (!place.full.load(std::memory_order_acquire)) continue;
        task = place.task;
        place.full.store(false, std::memory_order_release);
        count_.fetch_sub(1, std::memory_order_relaxed);
        return true;
      }
    }
    return false;
  }

 private:
  struct Place {
    std::atomic<bool> full{false};
    T task{};
  };
  std::vector<Place> places_;
  std::atomic<int> count_{0};
};

}  // namespace irt
