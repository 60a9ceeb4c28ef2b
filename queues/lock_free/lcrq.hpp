/// LCRQ: a linked list of rings whose places are given out by fetch-and-add (Morrison and Afek
/// 2013, "Fast Concurrent Queues for x86 Processors", PPoPP), with hazard pointers.
///
/// When to use: many cores push and pop at once. A fetch-and-add always succeeds, so nobody repeats
/// what others made fail, and at its place an operation meets only its counterpart. When not:
/// threads poll a queue that is mostly empty, for each look takes a ticket and spoils a place;
/// there are many small queues, for one has a ring of up to 64 KiB; the processor has no
/// compare-and-swap of 16 bytes, for then libatomic takes a lock: see `lprq`.
///
/// Ordering: FIFO in real time. Progress: lock-free, apart from the allocator. Memory: a ring of
/// 4,096 places of 16 bytes, and one more when it is full; a ring that was left waits for hazard
/// pointers, see there for the bound. Unbounded. A smaller `capacity`, rounded up to a power of
/// two, makes smaller rings. With fewer places than threads they close all the time.
///
/// How it works: linked_rings.hpp has the list, closable_ring.hpp the ring with its tickets. Here
/// is a place: the element beside the place's round and two flags, which are read and changed
/// together, 16 bytes at once.
///
/// What differs from the paper, and why:
/// - A place says that it is full by a bit of its own, so that every word can be an element.
/// - Places are read whole, 16 bytes at once. The paper reads one half after the other and lets the
///   compare-and-swap notice a change between them; C++ has no way to say that. On x86-64 libatomic
///   may read by a compare-and-swap, so that looking costs as much as writing. Therefore a push
///   does not look before its first try: it expects a place that was left in good order.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "queues/lock_free/closable_ring.hpp"
#include "queues/lock_free/linked_rings.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// A place of the paper's CRQ.
class CrqPlace {
 public:
  struct alignas(2 * sizeof(std::uint64_t)) View {
    std::uint64_t state = 0;  // the round above two flags
    std::uint64_t word = 0;

    [[nodiscard]] std::uint64_t round() const { return state >> 2U; }
    [[nodiscard]] bool is_full() const { return (state & 1U) != 0; }
    [[nodiscard]] bool is_unsafe() const { return (state & 2U) != 0; }
    [[nodiscard]] View made_unsafe() const { return {state | 2U, word}; }
    [[nodiscard]] View emptied_for(std::uint64_t round) const {
      return {round << 2U | (state & 2U), 0};
    }
  };

  /// Wait-free.
  [[nodiscard]] View look() const {
    // relaxed: what is seen is for (3) to confirm
    return place_.load(std::memory_order_relaxed);
  }

  static bool awaits(View seen, std::uint64_t round) {
    return !seen.is_full() && seen.round() <= round;
  }

  void put_first(std::uint64_t word) {
    // relaxed: whoever links the ring releases it
    place_.store(full(0, word), std::memory_order_relaxed);
  }

  /// Lock-free.
  template <class Overtaken>
  bool fill(std::uint64_t round, std::uint64_t word, unsigned /*worker*/, Overtaken overtaken) {
    View seen{round << 2U, 0};
    for (;;) {
      // (1) release: pairs with (3), so that the task is read as written
      // (2) acquire: on failure; pairs with (3), so that where a pop made the place unsafe its
      // ticket is seen below
      if (place_.compare_exchange_strong(seen, full(round, word), std::memory_order_release,
                                         std::memory_order_acquire))
        return true;
      if (seen.is_full() || seen.round() > round) return false;
      if (seen.is_unsafe() && overtaken()) return false;
    }
  }

  /// Lock-free.
  bool empty(View seen, std::uint64_t round, std::uint64_t& word) {
    while (seen.round() <= round) {
      const bool late = seen.is_full() && seen.round() < round;
      const View moved = late ? seen.made_unsafe() : seen.emptied_for(round + 1);
      // (3) acq_rel: pairs with (1) to take a task, with (2) to mark a place. relaxed on failure:
      // what was read is for the next try to confirm
      if (!place_.compare_exchange_strong(seen, moved, std::memory_order_acq_rel,
                                          std::memory_order_relaxed))
        continue;
      word = seen.word;
      return seen.is_full() && !late;
    }
    return false;
  }

 private:
  static View full(std::uint64_t round, std::uint64_t word) { return {round << 2U | 1U, word}; }

  std::atomic<View> place_;
};

template <class T>
class Lcrq : public LinkedRings<T, ClosableRing<CrqPlace>> {
 public:
  static constexpr std::string_view summary =
      "LCRQ: linked rings, fetch-and-add, 16-byte CAS, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .needs_cas2 = true};
  using LinkedRings<T, ClosableRing<CrqPlace>>::LinkedRings;
};

}  // namespace irt
