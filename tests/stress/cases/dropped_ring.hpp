/// A ring whose destructor goes from the oldest element to the first place that is free: where the
/// ring is full there is none, and it goes round for ever. The sisters differ in what they do on
/// the way: only look, write the same again, or count.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

enum class DropsRing : std::uint8_t { right, looks, wipes };

template <class T, DropsRing how>
class DroppedRingCase {
 public:
  static constexpr std::string_view summary = "a ring under a lock, and what its destructor does";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated};

  DroppedRingCase(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}
  DroppedRingCase(const DroppedRingCase&) = delete;
  DroppedRingCase& operator=(const DroppedRingCase&) = delete;

  ~DroppedRingCase() {
    for (std::size_t at = head_; places_[at].full; at = after(at)) {
      if (how == DropsRing::right) places_[at].full = false;
      if (how == DropsRing::wipes) places_[at].task = T{};
    }
  }

  bool push(unsigned /*worker*/, T task) {
    const std::scoped_lock lock(mutex_);
    if (places_[tail_].full) return false;
    places_[tail_].task = task;
    places_[tail_].full = true;
    tail_ = after(tail_);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::scoped_lock lock(mutex_);
    if (!places_[head_].full) return false;
    task = places_[head_].task;
    places_[head_].full = false;
    head_ = after(head_);
    return true;
  }

 private:
  struct Place {
    T task{};
    std::atomic<bool> full{false};
  };

  [[nodiscard]] std::size_t after(std::size_t at) const { return (at + 1) % places_.size(); }

  std::mutex mutex_;
  std::vector<Place> places_;
  std::size_t head_ = 0;
  std::size_t tail_ = 0;
};

template <class T>
class DroppedRingFixed : public DroppedRingCase<T, DropsRing::right> {
  using DroppedRingCase<T, DropsRing::right>::DroppedRingCase;
};
template <class T>
class DroppedRingLooksBug : public DroppedRingCase<T, DropsRing::looks> {
  using DroppedRingCase<T, DropsRing::looks>::DroppedRingCase;
};
template <class T>
class DroppedRingWipesBug : public DroppedRingCase<T, DropsRing::wipes> {
  using DroppedRingCase<T, DropsRing::wipes>::DroppedRingCase;
};

}  // namespace irt
