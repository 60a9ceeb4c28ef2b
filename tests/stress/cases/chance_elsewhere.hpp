/// A bag that asks the C library for a number, from a state that no execution puts back, when it
/// holds two elements. It has a data race, too, between a push and a pop, so that there is
/// something to withhold.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class ChanceElsewhereBug {
 public:
  static constexpr std::string_view summary = "a bag with a chance of its own, and a data race";
  static constexpr Claims claims{.survives_no_memory = false};

  ChanceElsewhereBug(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    ++pushes_;
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    if (tasks_.size() >= 2) odd_ = ::lrand48() / 1000 % 2 != 0;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const unsigned pushes = pushes_;
    const std::lock_guard lock(mutex_);
    if (pushes == 0 || tasks_.empty()) return false;
    task = tasks_.back();
    tasks_.pop_back();
    if (odd_) looks_.fetch_add(1, std::memory_order_relaxed);
    return true;
  }

 private:
  unsigned pushes_ = 0;
  std::atomic<unsigned> looks_{0};
  bool odd_ = false;
  std::mutex mutex_;
  std::vector<T> tasks_;
};

}  // namespace irt
