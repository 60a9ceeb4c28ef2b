/// A ring whose places are given out by fetch-and-add and that can be closed: what LCRQ and LPRQ
/// have in common (Morrison and Afek 2013, "Fast Concurrent Queues for x86 Processors", PPoPP,
/// section 4.1; Romanov and Koval 2023, "The State-of-the-Art LCRQ Concurrent Queue Algorithm Does
/// NOT Require CAS2", PPoPP).
///
/// When to use: as the ring of `LinkedRings`. When not: alone; a ring that closed stays closed.
///
/// Ordering: FIFO in real time. Progress: lock-free. Memory: 16 bytes a place, preallocated.
///
/// How it works: a push takes a ticket at the ring's tail, a pop one at its head, and the two with
/// the same ticket meet at one place. The place's round is ticket / places; a push fills a place of
/// its round or an earlier one, a pop empties it and moves it on to the next round. A pop that
/// comes first waits a little, then moves the place on all the same, and its push has to take
/// another ticket. A pop that finds an element of an earlier round, whose own pop is late, cannot
/// move the place on and marks it unsafe: from then on a push may fill it only if no pop has its
/// ticket yet. A push closes the ring for good when it is full or too many tickets in a row were
/// spoilt. How a place holds its element, its round and the mark is the places' own:
///
///     struct View;                                     // what was seen of a place
///     View look() const;                               // with any order: what follows confirms it
///     static bool awaits(View seen, std::uint64_t round);  // a push of the round may yet fill it
///     void put_first(std::uint64_t word);              // while nobody else knows it, in round 0
///     bool fill(std::uint64_t round, std::uint64_t word, unsigned worker, Overtaken overtaken);
///     bool empty(View seen, std::uint64_t round, std::uint64_t& word);
///
/// A new place is in round 0, and all zeros. `fill` asks `overtaken` whether a pop has had its
/// ticket, after an acquire that sees who made the place unsafe. When `empty` has answered false no
/// push can fill the place in this round any more.
///
/// What differs from the papers, and why:
/// - A place holds its round instead of its index, so that a new ring is all zeros.
/// - Tickets that follow each other have places in different cache lines, where the papers have one
///   place in each line.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "queues/cache_line.hpp"

namespace irt {

/// Tickets, each taken once: 0, 1, 2 ...; by a fetch-and-add each.
class PlainTickets {
 public:
  explicit PlainTickets(unsigned /*workers*/) {}

  /// Wait-free.
  std::uint64_t take(unsigned /*worker*/, std::memory_order order) {
    return next.fetch_add(1, order);
  }

  std::atomic<std::uint64_t> next{0};
};

/// `Tickets` as `PlainTickets`, or in a way that many threads can share better.
template <class Place, class Tickets = PlainTickets>
class ClosableRing {
 public:
  std::atomic<ClosableRing*> next{nullptr};

  /// 2^`bits` places; `bits` at least 1.
  ClosableRing(unsigned bits, unsigned workers)
      : bits_(bits), places_(std::size_t{1} << bits), head_(workers), tail_(workers) {}

  /// Adds the first word of a ring that nobody else knows yet.
  void put_first(std::uint64_t word) {
    places_[0].put_first(word);
    // relaxed: whoever links the ring releases it
    tail_.next.store(1, std::memory_order_relaxed);
  }

  /// Adds `word` at the back; false if the ring is closed, which it may do itself. Lock-free.
  bool put(unsigned worker, std::uint64_t word) {
    for (std::size_t tries = std::min(places_.size(), most_tries); tries > 0; --tries) {
      // (1) seq_cst: pairs with (3), so that a pop that begins later sees that there was a push
      const std::uint64_t ticket = tail_.take(worker, std::memory_order_seq_cst);
      if ((ticket & closed) != 0) return false;
      // relaxed: `fill` says what must be seen
      const auto overtaken = [&] { return head_.next.load(std::memory_order_relaxed) > ticket; };
      if (place_of(ticket).fill(ticket >> bits_, word, worker, overtaken)) return true;
      // relaxed: at worst an old head closes the ring too early
      const std::uint64_t ahead = ticket - head_.next.load(std::memory_order_relaxed);
      if (static_cast<std::int64_t>(ahead) >= static_cast<std::int64_t>(places_.size())) break;
    }
    // relaxed: who links a ring behind this one has read the bit, and the link tells the pops
    tail_.next.fetch_or(closed, std::memory_order_relaxed);
    return false;
  }

  /// Takes the oldest word; false if there is none. Lock-free.
  bool take(unsigned worker, std::uint64_t& word) {
    for (;;) {
      // (2) acq_rel: pairs with the one of the ticket before, and with the links of
      // linked_rings.hpp. A pop that began after a push had returned may have overtaken this one;
      // who has a later ticket must not miss that push there
      const std::uint64_t ticket = head_.take(worker, std::memory_order_acq_rel);
      Place& place = place_of(ticket);
      if (place.empty(await(place, ticket), ticket >> bits_, word)) return true;
      // (3) seq_cst: pairs with (1); an old tail would let us answer *empty* too early
      if ((tail_.next.load(std::memory_order_seq_cst) & ~closed) <= ticket + 1) {
        catch_up();
        return false;
      }
    }
  }

  /// The same: each ticket is a push's or spoilt.
  bool take_rest(unsigned worker, std::uint64_t& word) { return take(worker, word); }

 private:
  static constexpr std::uint64_t closed = std::uint64_t{1} << 63U;  // of the tail

  // So many tickets may be spoilt before a push gives the ring up; fewer where a new one is cheap.
  static constexpr std::size_t most_tries = 10;

  // Four places share a line of 64 bytes, so tickets that follow each other are four places apart.
  static_assert(sizeof(Place) == 16);
  Place& place_of(std::uint64_t ticket) {
    const std::uint64_t mask = places_.size() - 1;
    const std::uint64_t at = ticket & mask;
    return places_[(4 * at + (at >> (std::max(bits_, 2U) - 2))) & mask];
  }

  // What is at `place`, if possible when the push with `ticket` has been there. Waiting saves two
  // tickets, and at worst a new ring, so that a ring of more places is worth a longer wait.
  typename Place::View await(const Place& place, std::uint64_t ticket) {
    const std::uint64_t round = ticket >> bits_;
    typename Place::View seen = place.look();
    // relaxed: at worst we wait for nobody, or do not wait
    if (!Place::awaits(seen, round) ||
        (tail_.next.load(std::memory_order_relaxed) & ~closed) <= ticket)
      return seen;
    for (std::size_t looks = 1 + places_.size() / 64; looks > 0 && Place::awaits(seen, round);
         --looks) {
      pause();
      seen = place.look();
    }
    return seen;
  }

  // Pops have taken tickets that no push has had: moves the tail behind them.
  void catch_up() {
    // relaxed, all three: only tickets to be spoilt are saved; an old head saves fewer
    std::uint64_t tail = tail_.next.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint64_t head = head_.next.load(std::memory_order_relaxed);
      if (head <= tail) return;
      if (tail_.next.compare_exchange_strong(tail, head, std::memory_order_relaxed)) return;
    }
  }

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  unsigned bits_;
  std::vector<Place> places_;
  alignas(cache_line_pair) Tickets head_;
  alignas(cache_line_pair) Tickets tail_;
};

}  // namespace irt
