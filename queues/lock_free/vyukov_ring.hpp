/// Vyukov's bounded queue (2010, "Bounded MPMC queue", 1024cores.net): a ring whose places say
/// whose turn it is.
///
/// When to use: the number of tasks is bounded and memory must be allocated beforehand; producers
/// and consumers meet only at the place they share. When not: a thread may be stopped between
/// taking a place and filling it, for then all wait who come to that place a round later, and the
/// tasks behind it are not seen meanwhile.
///
/// Ordering: FIFO for each producer. Progress: blocking, in spite of its compare-and-swaps. Memory:
/// 16 bytes per place, preallocated. Bounded: the capacity is rounded up to a power of two, and at
/// least 2.
///
/// How it works: place `i` of `n` begins with turn `i`. The push with ticket `t` may fill place
/// `t mod n` when its turn is `t`, and makes it `t + 1`; the pop with ticket `t` may empty it then,
/// and makes it `t + n`. A ticket is taken by compare-and-swap once the turn has come, so nobody
/// waits with a ticket in hand. As in the original, places are not padded: neighbours share a line.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class VyukovRing {
 public:
  static constexpr std::string_view summary = "Vyukov's bounded ring, a turn in each place";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  VyukovRing(unsigned /*workers*/, std::size_t capacity)
      : places_(std::bit_ceil(std::max<std::size_t>(capacity, 2))), mask_(places_.size() - 1) {
    // relaxed: construction is single-threaded
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i].turn.store(i, std::memory_order_relaxed);
  }

  /// Adds `task` at the back; false if its place is still taken. Blocking.
  bool push(unsigned /*worker*/, T task) {
    // relaxed: tickets order nothing, the turns do
    std::size_t ticket = tail_.load(std::memory_order_relaxed);
    for (;;) {
      Place& place = places_[ticket & mask_];
      // (1) acquire: pairs with (4), so that the place is written after it was read
      const std::int64_t ahead = distance(place.turn.load(std::memory_order_acquire), ticket);
      if (ahead < 0) return false;
      if (ahead > 0) {
        // relaxed: as above
        ticket = tail_.load(std::memory_order_relaxed);
        // relaxed: a ticket is given once by being a read-modify-write, whatever its order
      } else if (tail_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_relaxed)) {
        place.task = std::move(task);
        // (2) release: pairs with (3), so that the task is read as written
        place.turn.store(ticket + 1, std::memory_order_release);
        return true;
      }
    }
  }

  /// Takes the oldest task; false if the first place is empty or not yet filled. Blocking.
  bool pop(unsigned /*worker*/, T& task) {
    // relaxed: as in push()
    std::size_t ticket = head_.load(std::memory_order_relaxed);
    for (;;) {
      Place& place = places_[ticket & mask_];
      // (3) acquire: pairs with (2)
      const std::int64_t ahead = distance(place.turn.load(std::memory_order_acquire), ticket + 1);
      if (ahead < 0) return false;
      if (ahead > 0) {
        // relaxed: as in push()
        ticket = head_.load(std::memory_order_relaxed);
        // relaxed: as in push()
      } else if (head_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_relaxed)) {
        task = std::move(place.task);
        // (4) release: pairs with (1)
        place.turn.store(ticket + places_.size(), std::memory_order_release);
        return true;
      }
    }
  }

 private:
  struct Place {
    std::atomic<std::size_t> turn{0};
    T task{};
  };

  // Counters wrap around; what counts is how far apart they are.
  static std::int64_t distance(std::size_t turn, std::size_t ticket) {
    return static_cast<std::int64_t>(turn - ticket);
  }

  std::vector<Place> places_;
  std::size_t mask_;
  alignas(cache_line_pair) std::atomic<std::size_t> head_{0};
  alignas(cache_line_pair) std::atomic<std::size_t> tail_{0};
};

}  // namespace irt
