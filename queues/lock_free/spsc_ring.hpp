/// A ring for one producer and one consumer, each of which remembers where it last saw the other
/// (Lamport 1983, "Specifying Concurrent Program Modules"; the remembered counters are those of Lee
/// et al. 2010, "A lock-free, cache-efficient multi-core synchronization mechanism for line-rate
/// network traffic monitoring", MCRingBuffer, and of many libraries since).
///
/// When to use: exactly one thread pushes and exactly one pops; nothing is faster there. When not:
/// anybody else might.
///
/// Ordering: FIFO by happens-before. Progress: wait-free. Memory: `capacity` places, allocated
/// once. Bounded.
///
/// How it works: each side counts what it has done, and only it writes that count. The other's
/// count is looked at when the remembered one leaves no place or no element, so that a ring that is
/// neither full nor empty moves no line of counts between the two cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class SpscRing {
 public:
  static constexpr std::string_view summary =
      "one producer, one consumer: a ring, counts remembered";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  SpscRing(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)) {}

  /// Adds `task` at the back; false if no place is free. Wait-free.
  bool push(unsigned /*worker*/, T task) {
    // relaxed: only the producer writes it
    const std::size_t pushed = producer_.done.load(std::memory_order_relaxed);
    if (pushed - producer_.others == places_.size()) {
      // (1) acquire: pairs with (4), so that the place is written after it was read
      producer_.others = consumer_.done.load(std::memory_order_acquire);
      if (pushed - producer_.others == places_.size()) return false;
    }
    places_[producer_.place] = std::move(task);
    advance(producer_.place);
    // (2) release: pairs with (3), so that the task is read as written
    producer_.done.store(pushed + 1, std::memory_order_release);
    return true;
  }

  /// Takes the oldest task; false if it sees none. Wait-free.
  bool pop(unsigned /*worker*/, T& task) {
    // relaxed: only the consumer writes it
    const std::size_t popped = consumer_.done.load(std::memory_order_relaxed);
    if (popped == consumer_.others) {
      // (3) acquire: pairs with (2)
      consumer_.others = producer_.done.load(std::memory_order_acquire);
      if (popped == consumer_.others) return false;
    }
    task = std::move(places_[consumer_.place]);
    advance(consumer_.place);
    // (4) release: pairs with (1)
    consumer_.done.store(popped + 1, std::memory_order_release);
    return true;
  }

 private:
  struct alignas(cache_line_pair) Side {
    std::atomic<std::size_t> done{0};
    std::size_t others = 0;  ///< the other's `done`, when last looked at
    std::size_t place = 0;   ///< of the next task
  };

  void advance(std::size_t& place) const { place = place + 1 == places_.size() ? 0 : place + 1; }

  std::vector<T> places_;
  Side producer_;
  Side consumer_;
};

}  // namespace irt
