/// LSCQ: a linked list of SCQ's rings (Nikolaev 2019, "A Scalable, Portable, and Memory-Efficient
/// Lock-Free FIFO Queue", DISC, section 5.3), with hazard pointers.
///
/// When to use: as LCRQ, on a processor without a compare-and-swap of 16 bytes, where every word
/// can be an element, or rings must not be given up before they are full. When not: a push and a
/// pop visit two rings of numbers each, so that LPRQ does half the work.
///
/// Ordering: FIFO in real time. Progress: lock-free, apart from the allocator. Memory: a ring of
/// 4,096 places of 40 bytes, and one more when it is full; a ring that was left waits for hazard
/// pointers, see there for the bound. Unbounded. A smaller `capacity`, rounded up to a power of
/// two, makes smaller rings, of at least as many places as there are workers.
///
/// How it works: linked_rings.hpp has the list, scq.hpp the ring. A push that finds no free place
/// closes the ring. Pushes that had their ticket by then may still fill places after a pop has
/// found the ring empty by its threshold; so the pop that looks once more before it leaves the ring
/// raises the threshold first, and goes through all tickets.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/lock_free/linked_rings.hpp"
#include "queues/lock_free/scq.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// SCQ as a ring that can be closed.
class ClosableScq {
 public:
  std::atomic<ClosableScq*> next{nullptr};

  /// 2^`bits` places, and at least `workers`.
  ClosableScq(unsigned bits, unsigned workers) : places_(workers, std::size_t{1} << bits) {}

  /// Adds the first word of a ring that nobody else knows yet.
  void put_first(std::uint64_t word) { places_.put(word); }

  /// Adds `word` at the back; false if the ring is closed, which it may do itself. Lock-free.
  bool put(unsigned /*worker*/, std::uint64_t word) {
    if (places_.put(word)) return true;
    places_.order().close();
    return false;
  }

  /// Takes the oldest word; false if there is none. Lock-free.
  bool take(unsigned /*worker*/, std::uint64_t& word) { return places_.take(word); }

  /// Of a closed ring; false only once nothing is inside or can come. Lock-free.
  bool take_rest(unsigned /*worker*/, std::uint64_t& word) {
    places_.order().look_again();
    return places_.take(word);
  }

 private:
  NumberedPlaces<std::uint64_t> places_;
};

template <class T>
class Lscq : public LinkedRings<T, ClosableScq> {
 public:
  static constexpr std::string_view summary =
      "LSCQ: linked rings of numbers, fetch-and-add, hazard pointers; no 16-byte CAS";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers};
  using LinkedRings<T, ClosableScq>::LinkedRings;
};

}  // namespace irt
