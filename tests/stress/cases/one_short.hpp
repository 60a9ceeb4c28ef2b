/// esphome/esphome#14892 (2026), alibaba/PhotonLibOS#203 (2023), rigtorp/SPSCQueue#4: a ring made
/// for N elements holds N - 1, since one place tells full from empty. Under a lock, so that nothing
/// else is wrong. Three claims, because what is asked of "full" depends on the order that is
/// claimed.
#pragma once

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool Fixed, Ordering order>
class OneShortCase {
 public:
  static constexpr std::string_view summary =
      "a ring under a lock, one place unused (esphome#14892)";
  static constexpr Claims claims{
      .ordering = order, .bounded = true, .reclamation = Reclamation::preallocated};

  OneShortCase(unsigned /*workers*/, std::size_t capacity) : slots_(capacity + (Fixed ? 1 : 0)) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    const std::size_t next = (head_ + 1) % slots_.size();
    if (next == tail_) return false;
    slots_[head_] = task;
    head_ = next;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    if (head_ == tail_) return false;
    task = slots_[tail_];
    tail_ = (tail_ + 1) % slots_.size();
    return true;
  }

 private:
  std::mutex mutex_;
  std::vector<T> slots_;
  std::size_t head_ = 0;
  std::size_t tail_ = 0;
};

template <class T>
class OneShortBug : public OneShortCase<T, false, Ordering::fifo_real_time> {
  using OneShortCase<T, false, Ordering::fifo_real_time>::OneShortCase;
};
template <class T>
class OneShortFixed : public OneShortCase<T, true, Ordering::fifo_real_time> {
  using OneShortCase<T, true, Ordering::fifo_real_time>::OneShortCase;
};
template <class T>
class OneShortProducersBug : public OneShortCase<T, false, Ordering::per_producer_fifo> {
  using OneShortCase<T, false, Ordering::per_producer_fifo>::OneShortCase;
};
template <class T>
class OneShortUnorderedBug : public OneShortCase<T, false, Ordering::unordered> {
  using OneShortCase<T, false, Ordering::unordered>::OneShortCase;
};

}  // namespace irt
