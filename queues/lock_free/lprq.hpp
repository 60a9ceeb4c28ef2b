/// LPRQ: LCRQ without a compare-and-swap of 16 bytes (Romanov and Koval 2023, "The State-of-the-Art
/// LCRQ Concurrent Queue Algorithm Does NOT Require CAS2", PPoPP), with hazard pointers.
///
/// When to use: as LCRQ, on any processor that has compare-and-swap and fetch-and-add of a word.
/// When not: threads poll a queue that is mostly empty, for each look takes a ticket and spoils a
/// place; there are many small queues, for one has a ring of up to 64 KiB; elements need their top
/// bit, or may be 0: see `lcrq`.
///
/// Ordering: FIFO in real time. Progress: lock-free, apart from the allocator. Memory: a ring of
/// 4,096 places of 16 bytes, and one more when it is full; a ring that was left waits for hazard
/// pointers, see there for the bound. Unbounded. A smaller `capacity`, rounded up to a power of
/// two, makes smaller rings. With fewer places than threads they close all the time.
///
/// How it works: linked_rings.hpp has the list, closable_ring.hpp the ring with its tickets. Here
/// is a place: two words, one for the element and one for the place's round and the mark *unsafe*,
/// which are changed one after the other. A push first locks the place by a word that is its
/// worker's own in place of the element; then it moves the round on, which says that the place is
/// its ticket's now; then it puts its element where its lock is. Any pop may break the lock before
/// that, and the push takes another ticket. Since the lock is the worker's own, no other push can
/// take it for its own, and a step that comes too late fails. So an element in the place always
/// belongs to the round that stands beside it.
///
/// What differs from the paper, and why: a push that finds its lock broken, or the round moved on
/// before its own, takes another ticket, and a pop that comes first waits for a number of looks
/// that does not depend on what others do (closable_ring.hpp), so that a ring's places differ in
/// nothing else from LCRQ's.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "queues/lock_free/closable_ring.hpp"
#include "queues/lock_free/linked_rings.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// A place of the paper's PRQ.
class PrqPlace {
 public:
  /// Of a word: no element has it.
  static constexpr std::uint64_t lock_bit = std::uint64_t{1} << 63U;

  struct View {
    std::uint64_t state = 0;  // the round above one flag
    std::uint64_t word = 0;   // an element, a push's lock, or nothing

    [[nodiscard]] std::uint64_t round() const { return state >> 1U; }
    [[nodiscard]] bool is_unsafe() const { return (state & unsafe) != 0; }
    [[nodiscard]] bool is_locked() const { return (word & lock_bit) != 0; }
    [[nodiscard]] bool is_full() const { return word != nothing && !is_locked(); }
  };

  /// Wait-free.
  [[nodiscard]] View look() const {
    // (1) acquire: pairs with (3), so that who sees a round that a push has moved on to sees its
    // lock, too, and breaks it; with (6), so that who sees a mark sees the ticket of who made it
    const std::uint64_t state = state_.load(std::memory_order_acquire);
    // (2) acquire: pairs with (4), so that the task is read as written, and its round is seen by
    // (5)
    return {state, word_.load(std::memory_order_acquire)};
  }

  // A push that has its lock in the place has moved the round on, or is about to.
  static bool awaits(View seen, std::uint64_t round) {
    return !seen.is_full() && seen.round() <= round + (seen.is_locked() ? 1 : 0);
  }

  void put_first(std::uint64_t word) {
    // relaxed, twice: whoever links the ring releases them
    state_.store(state_of(1), std::memory_order_relaxed);
    word_.store(word, std::memory_order_relaxed);
  }

  /// Wait-free.
  template <class Overtaken>
  bool fill(std::uint64_t round, std::uint64_t word, unsigned worker, Overtaken overtaken) {
    const View seen = look();
    if (seen.word != nothing || seen.round() > round) return false;
    if (seen.is_unsafe() && overtaken()) return false;
    const std::uint64_t lock = lock_bit | worker;
    std::uint64_t expected = nothing;
    // relaxed, twice: (3) publishes the lock
    if (!word_.compare_exchange_strong(expected, lock, std::memory_order_relaxed)) return false;
    std::uint64_t state = seen.state;
    // (3) release: pairs with (1). relaxed on failure: the place is another's
    const bool mine = state_.compare_exchange_strong(
        state, state_of(round + 1), std::memory_order_release, std::memory_order_relaxed);
    expected = lock;
    // (4) release: pairs with (2). relaxed on failure: a pop has broken the lock
    return word_.compare_exchange_strong(expected, mine ? word : nothing, std::memory_order_release,
                                         std::memory_order_relaxed) &&
           mine;
  }

  /// Lock-free.
  bool empty(View seen, std::uint64_t round, std::uint64_t& word) {
    for (;; seen = look()) {
      // (5) relaxed: (2) is an acquire. Only what lay there together is worth a thought
      if (state_.load(std::memory_order_relaxed) != seen.state) continue;
      if (seen.round() > round + 1) return false;
      if (!seen.is_full()) {
        // relaxed, twice: a lock is broken or not
        if (seen.is_locked() &&
            !word_.compare_exchange_strong(seen.word, nothing, std::memory_order_relaxed))
          continue;
        const std::uint64_t moved = state_of(round + 1) | (seen.state & unsafe);
        // relaxed, twice: who sees the new round takes another ticket
        if (seen.round() == round + 1 ||
            state_.compare_exchange_strong(seen.state, moved, std::memory_order_relaxed))
          return false;
      } else if (seen.round() == round + 1) {
        // relaxed: nobody else may take it, and a push that sees this late takes another ticket
        word_.store(nothing, std::memory_order_relaxed);
        word = seen.word;
        return true;
      } else if (seen.is_unsafe() ||
                 // (6) release: pairs with (1). relaxed on failure: another look follows
                 state_.compare_exchange_strong(seen.state, seen.state | unsafe,
                                                std::memory_order_release,
                                                std::memory_order_relaxed)) {
        return false;
      }
    }
  }

 private:
  static constexpr std::uint64_t nothing = 0;
  static constexpr std::uint64_t unsafe = 1;  // of a state
  static std::uint64_t state_of(std::uint64_t round) { return round << 1U; }

  std::atomic<std::uint64_t> state_{0};
  std::atomic<std::uint64_t> word_{nothing};
};

template <class T>
class Lprq : public LinkedRings<T, ClosableRing<PrqPlace>> {
 public:
  static constexpr std::string_view summary =
      "LPRQ: linked rings, fetch-and-add, hazard pointers; no 16-byte CAS";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .reserved = {0},
                                 .unused_bits = PrqPlace::lock_bit};
  using LinkedRings<T, ClosableRing<PrqPlace>>::LinkedRings;
};

}  // namespace irt
