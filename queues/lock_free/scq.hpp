/// SCQ: a bounded ring of words, made of two rings of numbers (Nikolaev 2019, "A Scalable,
/// Portable, and Memory-Efficient Lock-Free FIFO Queue", DISC).
///
/// When to use: the number of tasks is bounded, memory must be allocated beforehand, and a stopped
/// thread must not stop the others, which `vyukov-ring` cannot promise; the processor has no
/// compare-and-swap of 16 bytes. When not: nothing is known of the number of tasks: see `lscq`.
///
/// Ordering: FIFO in real time; *full* counts places that calls in flight hold. Progress:
/// lock-free. Memory: per place 32 bytes and an element, preallocated. Bounded: the capacity is
/// rounded up to a power of two, and at least the number of workers.
///
/// How it works: elements lie in an array of n places. One ring has the numbers of those that are
/// free, the other those that are filled, in order: a push takes a free number, writes its element
/// there and puts the number into the other ring, a pop the other way round. So a ring only ever
/// has numbers below n, each at most once, in 2n places, and a word has room for the number beside
/// the place's round (*cycle*) and the mark *safe*; and since a number that is put always finds a
/// place, a ring needs neither to be closed nor to be replaced.
///
/// A put takes a ticket at the tail, a take one at the head. A take that comes first moves the
/// place on to its round, so that the put has to take another ticket; one that finds a number of an
/// earlier round takes away the mark *safe*, without which a put must see that no take has its
/// ticket. Takes of an empty ring would run ahead for ever and spoil the tickets of puts. They stop
/// at a threshold: a put sets it to 3n - 1, each failed take counts down. The last number lies at
/// most 2n tickets behind the head that its put saw, and n takes may be under way, so that at less
/// than 0 nothing is inside, and takes need no ticket to know it.
///
/// What differs from the paper: tickets that follow each other have places in different cache lines
/// by a rotation; a put does not say whether the queue is full, since that never happens.
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

/// A ring of the numbers below n, each at most once inside (the paper's figures 7 and 8); of at
/// most n threads at a time.
class NumberRing {
 public:
  /// n is 2^`bits`; all numbers are inside, in order, or none.
  NumberRing(unsigned bits, bool full)
      : bits_(bits),
        entries_(std::size_t{2} << bits),
        threshold_(full ? most_failures() : -1),
        head_(places()),
        tail_(places() + (full ? places() / 2 : 0)) {
    // relaxed: construction is single-threaded
    for (std::atomic<std::uint64_t>& entry : entries_)
      entry.store(entry_of(0, none()), std::memory_order_relaxed);
    for (std::uint64_t number = 0; full && number < places() / 2; ++number)
      entry_at(places() + number).store(entry_of(1, number), std::memory_order_relaxed);
  }

  /// Adds a number that is not inside at the back; false if the ring is closed. Lock-free.
  bool put(std::uint64_t number) {
    for (;;) {
      // (1) seq_cst: pairs with (7), so that a take that begins later sees that there was a put
      const std::uint64_t ticket = tail_.fetch_add(1, std::memory_order_seq_cst);
      if ((ticket & closed) != 0) return false;
      std::atomic<std::uint64_t>& entry = entry_at(ticket);
      // (2) acquire: pairs with (10), so that where a take has unmarked the place its ticket is
      // seen below, be it relaxed
      std::uint64_t seen = entry.load(std::memory_order_acquire);
      while (round_of(seen) < round_at(ticket) && number_in(seen) == none() &&
             (is_safe(seen) || head_.load(std::memory_order_relaxed) <= ticket)) {
        // (3) seq_cst: pairs with (9), so that what the number stands for is read as written; with
        // (6), so that a later ticket does not miss it; and with (8): an old threshold, read below,
        // would not be raised although takes had gone by this place before
        // (11) acquire: on failure; pairs with (10)
        if (!entry.compare_exchange_weak(seen, entry_of(round_at(ticket), number),
                                         std::memory_order_seq_cst, std::memory_order_acquire))
          continue;
        // (4) seq_cst: twice; pairs with (5) and (8), so that a take that begins later looks
        if (threshold_.load(std::memory_order_seq_cst) != most_failures())
          threshold_.store(most_failures(), std::memory_order_seq_cst);
        return true;
      }
    }
  }

  /// Takes the oldest number; false if there is none. Lock-free.
  bool take(std::uint64_t& number) {
    // (5) seq_cst: pairs with (4)
    if (threshold_.load(std::memory_order_seq_cst) < 0) return false;
    for (;;) {
      // (6) acq_rel: pairs with the one of the ticket before, and with (3). A take that began after
      // a put had returned may have overtaken this one; who has a later ticket must not miss that
      // put
      const std::uint64_t ticket = head_.fetch_add(1, std::memory_order_acq_rel);
      if (empty(ticket, number)) return true;
      // (7) seq_cst: pairs with (1); an old tail would let us answer *empty* too early
      const std::uint64_t tail = tail_.load(std::memory_order_seq_cst) & ~closed;
      const bool at_end = tail <= ticket + 1;
      if (at_end) catch_up(ticket + 1);
      // (8) seq_cst: pairs with (3) and (4)
      if (threshold_.fetch_sub(1, std::memory_order_seq_cst) <= 0 || at_end) return false;
    }
  }

  /// From now on nothing can be put, but by those that have their ticket. Wait-free.
  void close() {
    // relaxed: who links a ring behind this one has read the bit, and the link tells the others
    tail_.fetch_or(closed, std::memory_order_relaxed);
  }

  /// Takes of a closed ring look at all tickets again. Wait-free.
  void look_again() {
    // relaxed: for this thread's own takes, whatever others count meanwhile
    threshold_.store(most_failures(), std::memory_order_relaxed);
  }

 private:
  static constexpr std::uint64_t closed = std::uint64_t{1} << 63U;  // of the tail

  // An entry: the round, the mark, and bits_ + 1 bits of the number, all of them ones for none.
  [[nodiscard]] std::uint64_t places() const { return std::uint64_t{2} << bits_; }
  [[nodiscard]] std::int64_t most_failures() const {
    return static_cast<std::int64_t>(places() + places() / 2 - 1);
  }
  [[nodiscard]] std::uint64_t none() const { return places() - 1; }
  [[nodiscard]] std::uint64_t safe() const { return places(); }
  [[nodiscard]] std::uint64_t entry_of(std::uint64_t round, std::uint64_t number) const {
    return round << (bits_ + 2) | safe() | number;
  }
  [[nodiscard]] std::uint64_t number_in(std::uint64_t entry) const { return entry & none(); }
  [[nodiscard]] bool is_safe(std::uint64_t entry) const { return (entry & safe()) != 0; }
  [[nodiscard]] std::uint64_t round_of(std::uint64_t entry) const { return entry >> (bits_ + 2); }
  [[nodiscard]] std::uint64_t round_at(std::uint64_t ticket) const { return ticket >> (bits_ + 1); }

  // Eight entries share a line of 64 bytes, so tickets that follow each other are eight apart.
  std::atomic<std::uint64_t>& entry_at(std::uint64_t ticket) {
    const std::uint64_t at = ticket & (places() - 1);
    return entries_[(8 * at + (at >> (std::max(bits_ + 1, 3U) - 3))) & (places() - 1)];
  }

  // Takes the number of `ticket`, or sees to it that no put can leave it there any more.
  bool empty(std::uint64_t ticket, std::uint64_t& number) {
    std::atomic<std::uint64_t>& entry = entry_at(ticket);
    // relaxed: what is seen is for (9) and (10) to confirm
    std::uint64_t seen = entry.load(std::memory_order_relaxed);
    for (;;) {
      if (round_of(seen) == round_at(ticket)) {
        // (9) acquire: pairs with (3). The place keeps its round and its mark
        number = number_in(entry.fetch_or(none(), std::memory_order_acquire));
        return true;
      }
      if (round_of(seen) > round_at(ticket)) return false;
      const std::uint64_t moved = number_in(seen) == none()
                                      ? round_at(ticket) << (bits_ + 2) | (seen & safe()) | none()
                                      : seen & ~safe();
      // (10) release: pairs with (2) and (11). relaxed on failure: as above
      if (seen == moved || entry.compare_exchange_weak(seen, moved, std::memory_order_release,
                                                       std::memory_order_relaxed))
        return false;
    }
  }

  // Takes have had tickets that no put has had: moves the tail behind them.
  void catch_up(std::uint64_t head) {
    // relaxed, all three: only tickets to be spoilt are saved
    std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    while (tail < head && !tail_.compare_exchange_weak(tail, head, std::memory_order_relaxed))
      head = head_.load(std::memory_order_relaxed);
  }

  const unsigned bits_;
  std::vector<std::atomic<std::uint64_t>> entries_;
  alignas(cache_line_pair) std::atomic<std::int64_t> threshold_;
  alignas(cache_line_pair) std::atomic<std::uint64_t> head_;
  alignas(cache_line_pair) std::atomic<std::uint64_t> tail_;
};

/// n places for elements, n a power of two, and who is in them.
template <class T>
class NumberedPlaces {
 public:
  /// At least `capacity` places, and at least `workers`: so many calls may hold a number each.
  NumberedPlaces(unsigned workers, std::size_t capacity)
      : bits_(static_cast<unsigned>(
            std::bit_width(std::max<std::size_t>({capacity, workers, 2}) - 1))),
        free_(bits_, true),
        filled_(bits_, false),
        elements_(std::size_t{1} << bits_) {}

  /// Adds `element` at the back, and leaves it alone where it answers false: no place is free, or
  /// the ring is closed. Lock-free.
  bool put(T& element) {
    std::uint64_t number = 0;
    if (!free_.take(number)) return false;
    elements_[number] = std::move(element);
    if (filled_.put(number)) return true;
    element = std::move(elements_[number]);
    free_.put(number);
    return false;
  }

  /// Takes the oldest element; false if there is none. Lock-free.
  bool take(T& element) {
    std::uint64_t number = 0;
    if (!filled_.take(number)) return false;
    element = std::move(elements_[number]);
    free_.put(number);
    return true;
  }

  /// Of those that are filled.
  NumberRing& order() { return filled_; }

 private:
  const unsigned bits_;
  NumberRing free_;
  NumberRing filled_;
  std::vector<T> elements_;
};

template <class T>
class Scq {
 public:
  static constexpr std::string_view summary = "SCQ: a bounded lock-free ring, two rings of numbers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .full = Answer::calls_in_flight,
                                 .reclamation = Reclamation::preallocated,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  Scq(unsigned workers, std::size_t capacity) : places_(workers, capacity) {}

  /// Adds `task` at the back; false if it finds no free place. Lock-free.
  bool push(unsigned /*worker*/, T task) { return places_.put(task); }

  /// Takes the oldest task; false if there is none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) { return places_.take(task); }

 private:
  NumberedPlaces<T> places_;
};

}  // namespace irt
