/// A bag that hands its elements over by relaxed operations. Each element leaves once, so nothing
/// that looks at the elements alone notices; what an element points to is not published. A task
/// written before push() and read after pop() is a data race.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T, std::memory_order order>
class UnpublishedCase {
 public:
  static constexpr std::string_view summary = "a bag that hands over by one exchange";
  static constexpr Claims claims{
      .bounded = true, .reclamation = Reclamation::preallocated, .all_ones_reserved = true};

  UnpublishedCase(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}

  bool push(unsigned /*worker*/, T task) {
    for (auto& place : places_) {
      std::uint64_t none = 0;
      if (place.compare_exchange_strong(none, ~word_of(task), order, std::memory_order_relaxed))
        return true;
    }
    return false;
  }

  bool pop(unsigned /*worker*/, T& task) {
    for (auto& place : places_) {
      const std::uint64_t word = place.exchange(0, order);
      if (word == 0) continue;
      task = element_of<T>(~word);
      return true;
    }
    return false;
  }

 private:
  std::vector<std::atomic<std::uint64_t>> places_;
};

template <class T>
class UnpublishedBug : public UnpublishedCase<T, std::memory_order_relaxed> {
  using UnpublishedCase<T, std::memory_order_relaxed>::UnpublishedCase;
};
template <class T>
class UnpublishedFixed : public UnpublishedCase<T, std::memory_order_acq_rel> {
  using UnpublishedCase<T, std::memory_order_acq_rel>::UnpublishedCase;
};

}  // namespace irt
