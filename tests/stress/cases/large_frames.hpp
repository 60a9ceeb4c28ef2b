/// Bags under a lock whose pop needs much stack: less than a thread of Linux has, or without end.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool endless>
class LargeFrames_ {
 public:
  static constexpr std::string_view summary = "a bag under a lock whose pop needs much stack";
  static constexpr Claims claims{.survives_no_memory = false};

  LargeFrames_(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    return walk(tasks_.size(), task);
  }

 private:
  // NOLINTNEXTLINE(misc-no-recursion)
  [[gnu::noinline]] bool walk(std::size_t left, T& task) {
    std::array<unsigned char, 400'000> frame;
    // Somebody looks at it, or a compiler leaves it out.
    asm volatile("" : : "r"(frame.data()) : "memory");
    bool found = false;
    if (endless && left != ~std::size_t{0}) {
      found = walk(left + 1, task);
    } else if (left != 0) {
      task = tasks_.back();
      tasks_.pop_back();
      found = true;
    }
    asm volatile("" : : "r"(frame.data()) : "memory");
    return found;
  }

  std::mutex mutex_;
  std::vector<T> tasks_;
};

template <class T>
class EndlessRecursionBug : public LargeFrames_<T, true> {
  using LargeFrames_<T, true>::LargeFrames_;
};
template <class T>
class LargeFrames : public LargeFrames_<T, false> {
  using LargeFrames_<T, false>::LargeFrames_;
};

}  // namespace irt
