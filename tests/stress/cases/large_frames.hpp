/// Queues under a lock whose pop needs much stack: less than a thread of Linux has, or without end.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "queues/blocking/mutex_queue.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool endless>
class LargeFramesCase {
 public:
  static constexpr std::string_view summary = "a queue under a lock whose pop needs much stack";
  static constexpr Claims claims{.survives_no_memory = false};

  LargeFramesCase(unsigned workers, std::size_t capacity) : tasks_(workers, capacity) {}

  bool push(unsigned worker, T task) { return tasks_.push(worker, task); }
  bool pop(unsigned worker, T& task) { return walk(worker, task, 0); }

 private:
  // NOLINTNEXTLINE(misc-no-recursion)
  [[gnu::noinline]] bool walk(unsigned worker, T& task, std::size_t depth) {
    std::array<unsigned char, 400'000> frame;
    // Somebody looks at it, or a compiler leaves it out.
    asm volatile("" : : "r"(frame.data()) : "memory");
    const bool found = endless && depth != ~std::size_t{0} ? walk(worker, task, depth + 1)
                                                           : tasks_.pop(worker, task);
    asm volatile("" : : "r"(frame.data()) : "memory");
    return found;
  }

  MutexQueue<T> tasks_;
};

template <class T>
using EndlessRecursionBug = LargeFramesCase<T, true>;
template <class T>
using LargeFrames = LargeFramesCase<T, false>;

}  // namespace irt
