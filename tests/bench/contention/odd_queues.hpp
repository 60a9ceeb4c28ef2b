/// Queues for tests of the benchmark: some misbehave after a while, two are twins of which either
/// can be slowed on purpose.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <new>
#include <queue>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt::odd {

enum class Oddity { none, hangs, crashes, loses, throws };

/// A deque under a lock, which turns odd with the 1,000th pop. `Variable`, of the environment, is
/// how many steps a push waits in addition.
template <class T, Oddity oddity, class Variable>
class Queue {
 public:
  static constexpr std::string_view summary = "a queue for tests";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  Queue(unsigned /*workers*/, std::size_t /*capacity*/) {
    if (const char* text = std::getenv(Variable::name)) {
      steps_ = std::strtoul(text, nullptr, 10);
    }
  }

  bool push(unsigned /*worker*/, T task) {
    std::uint64_t x = 1;
    for (unsigned long left = steps_; left > 0; --left) {
      x = x * 6364136223846793005U + 1442695040888963407U;
      asm volatile("" : "+r"(x));
    }
    const std::lock_guard lock(mutex_);
    queue_.push(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    if (oddity != Oddity::none && ++pops_ >= 1000) {
      if (oddity == Oddity::hangs) {
        for (;;) {
          asm volatile("");
        }
      }
      if (oddity == Oddity::crashes) std::abort();
      if (oddity == Oddity::throws) throw std::bad_alloc();
    }
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return false;
    task = queue_.front();
    queue_.pop();
    if (oddity == Oddity::loses && pops_ % 1000 == 0 && !queue_.empty()) queue_.pop();
    return true;
  }

 private:
  unsigned long steps_ = 0;
  std::atomic<unsigned> pops_{0};
  std::mutex mutex_;
  std::queue<T> queue_;
};

struct TwinASteps {
  static constexpr const char* name = "IRT_TWIN_A_STEPS";
};
struct TwinBSteps {
  static constexpr const char* name = "IRT_TWIN_B_STEPS";
};

template <class T>
using Hanging = Queue<T, Oddity::hangs, TwinASteps>;
template <class T>
using Crashing = Queue<T, Oddity::crashes, TwinASteps>;
template <class T>
using Losing = Queue<T, Oddity::loses, TwinASteps>;
template <class T>
using Throwing = Queue<T, Oddity::throws, TwinASteps>;
template <class T>
using TwinA = Queue<T, Oddity::none, TwinASteps>;
template <class T>
using TwinB = Queue<T, Oddity::none, TwinBSteps>;

}  // namespace irt::odd
