/// Healthy: a bag whose pop looks at each place `looks` times, by seq_cst loads, before it passes
/// it by. Rings that wait a bounded while for a push under way do so (LCRQ, SCQ: thousands of
/// looks).
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

template <class T, int looks>
class PatientCase {
 public:
  static constexpr std::string_view summary = "a bag whose pop looks many times at each place";
  static constexpr Claims claims{
      .bounded = true, .reclamation = Reclamation::preallocated, .all_ones_reserved = true};

  PatientCase(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}

  bool push(unsigned /*worker*/, T task) {
    for (auto& place : places_) {
      std::uint64_t none = 0;
      if (place.compare_exchange_strong(none, ~word_of(task))) return true;
    }
    return false;
  }

  bool pop(unsigned /*worker*/, T& task) {
    for (auto& place : places_) {
      int look = 0;
      while (look < looks && place.load() == 0) ++look;
      if (look == looks) continue;
      const std::uint64_t word = place.exchange(0);
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
class Patient : public PatientCase<T, 4'000> {
  using PatientCase<T, 4'000>::PatientCase;
};

}  // namespace irt
