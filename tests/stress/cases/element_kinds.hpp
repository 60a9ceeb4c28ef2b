/// Rings under a lock for elements that are more than a word, each with one bug, beside a sound
/// one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

enum class ElementBug : std::uint8_t {
  none,
  tears,         ///< copies the halves of an element outside of the lock
  twice,         ///< hands out what it keeps a copy of, as bytes
  counts_early,  ///< counts a place before its element is copied there, which may throw
};

template <class T, ElementBug bug>
class ElementRing {
 public:
  static constexpr std::string_view summary = "a ring under a lock, of any elements";
  static constexpr Claims claims{
      .ordering = Ordering::fifo_real_time,
      .bounded = true,
      .reclamation = Reclamation::preallocated,
      .elements = {.large = true,
                   .owner = bug == ElementBug::none || bug == ElementBug::twice,
                   .copied = bug == ElementBug::none || bug == ElementBug::counts_early}};

  ElementRing(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    if (pushed_ - popped_ == places_.size()) return false;
    T& place = places_[pushed_ % places_.size()];
    if constexpr (bug == ElementBug::counts_early) {
      ++pushed_;
      place = static_cast<const T&>(task);
      return true;
    }
    place = std::move(task);
    ++pushed_;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    if (popped_ == pushed_) return false;
    T& place = places_[popped_++ % places_.size()];
    if (bug == ElementBug::tears) lock.unlock();
    if constexpr (bug == ElementBug::twice) {
      if constexpr (sizeof(T) == sizeof(void*)) {
        // As code does that takes every element for bytes.
        __builtin_memcpy(static_cast<void*>(&task), &place, sizeof task);
        return true;
      }
    }
    task = std::move(place);
    return true;
  }

 private:
  std::mutex mutex_;
  std::vector<T> places_;
  std::size_t pushed_ = 0;
  std::size_t popped_ = 0;
};

template <class T>
using ElementRingSound = ElementRing<T, ElementBug::none>;
template <class T>
using ElementRingTearsBug = ElementRing<T, ElementBug::tears>;
template <class T>
using ElementRingTwiceBug = ElementRing<T, ElementBug::twice>;
template <class T>
using ElementRingCountsEarlyBug = ElementRing<T, ElementBug::counts_early>;

}  // namespace irt
