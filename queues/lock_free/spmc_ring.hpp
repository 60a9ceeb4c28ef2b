/// A ring for one producer and many consumers: the thieves' half of a work-stealing deque (Chase
/// and Lev 2005; the orders are those of Lê et al. 2013, "Correct and Efficient Work-Stealing for
/// Weak Memory Models", where the owner only pushes).
///
/// When to use: one thread deals tasks to all others. When not: consumers are many and tasks small,
/// for all of them take turns at one counter.
///
/// Ordering: FIFO by happens-before. Progress: push wait-free, pop lock-free. Memory: `capacity`
/// places, allocated once. Bounded.
///
/// How it works: the producer fills the next place and counts it. A consumer reads the oldest task
/// and then takes it by moving the other counter; whoever fails has read in vain. So places are
/// atomic: one may be filled again while a consumer who will fail still reads it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class SpmcRing {
 public:
  static constexpr std::string_view summary =
      "one producer, many consumers: a ring of a deque's thieves";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  SpmcRing(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}

  /// Adds `task` at the back; false if no place is free. Wait-free.
  bool push(unsigned /*worker*/, T task) {
    // relaxed: only the producer writes it
    const std::size_t pushed = pushed_.load(std::memory_order_relaxed);
    // (1) acquire: pairs with (4), so that the place is filled after it was read. (The checker
    // knows no load buffering, and proves the queue without.)
    if (pushed - popped_.load(std::memory_order_acquire) >= places_.size()) return false;
    // relaxed: (2) publishes it
    places_[pushed % places_.size()].store(task, std::memory_order_relaxed);
    // (2) release: pairs with (3), so that the task is read as written
    pushed_.store(pushed + 1, std::memory_order_release);
    return true;
  }

  /// Takes the oldest task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) {
    // (5) acquire: pairs with (4), so that no element is missed whose push came before a pop that
    // is seen here
    std::size_t popped = popped_.load(std::memory_order_acquire);
    for (;;) {
      // (3) acquire: pairs with (2)
      const std::size_t pushed = pushed_.load(std::memory_order_acquire);
      if (pushed == popped) return false;
      // relaxed: (3) orders it, and one that is filled again by then is not taken
      const T taken = places_[popped % places_.size()].load(std::memory_order_relaxed);
      // (4) release: pairs with (1), (5) and (6)
      // (6) acquire: pairs with (4), where somebody else took the task
      if (popped_.compare_exchange_strong(popped, popped + 1, std::memory_order_release,
                                          std::memory_order_acquire)) {
        task = taken;
        return true;
      }
    }
  }

 private:
  std::vector<std::atomic<T>> places_;
  alignas(cache_line_pair) std::atomic<std::size_t> pushed_{0};
  alignas(cache_line_pair) std::atomic<std::size_t> popped_{0};
};

}  // namespace irt
