/// FAAArrayQueue: a linked list of arrays whose places are given out by fetch-and-add and used once
/// (Correia and Ramalhete 2016, "FAAArrayQueue - MPMC lock-free queue (part 4 of 4)", Concurrency
/// Freaks), with hazard pointers.
///
/// When to use: as the small relative of LCRQ: what tickets bring, in a dozen lines, and with looks
/// at an empty queue that write nothing. When not: throughput at full load counts, for each element
/// uses up a place, and every 4,096th push allocates an array of 32 KiB that is cold; elements may
/// be 0 or have all bits set.
///
/// Ordering: FIFO in real time. Progress: lock-free, apart from the allocator. Memory: an array of
/// 4,096 places of 8 bytes, and one more when it is used up; an array that was left waits for
/// hazard pointers, see there for the bound. Unbounded. A smaller `capacity`, rounded up to a power
/// of two, makes smaller arrays.
///
/// How it works: linked_rings.hpp has the list. A push takes a ticket and changes the place of that
/// number from *nothing* to its element; a pop takes a ticket and swaps *taken* into its place.
/// Where the pop comes first, the push finds *taken* and takes the next ticket. An array is closed
/// once all tickets have been given out.
///
/// What differs from the original, and why:
/// - Tickets that follow each other have places in different cache lines.
/// - A pop looks at the tail for *empty* with sequential consistency, and never at `next` for that.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/lock_free/linked_rings.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// An array each of whose places has one element, ever.
class UsedOnceArray {
 public:
  static constexpr std::uint64_t nothing = 0;
  static constexpr std::uint64_t taken = ~std::uint64_t{0};

  std::atomic<UsedOnceArray*> next{nullptr};

  /// 2^`bits` places; `bits` at least 1.
  UsedOnceArray(unsigned bits, unsigned /*workers*/)
      : bits_(bits), places_(std::size_t{1} << bits) {}

  /// Adds the first word of an array that nobody else knows yet.
  void put_first(std::uint64_t word) {
    // relaxed, twice: whoever links the array releases it
    places_[0].store(word, std::memory_order_relaxed);
    tail_.store(1, std::memory_order_relaxed);
  }

  /// Adds `word` at the back; false if the array is used up. Lock-free.
  bool put(unsigned /*worker*/, std::uint64_t word) {
    for (;;) {
      // (1) seq_cst: pairs with (3), so that a pop that begins later sees that there was a push
      const std::uint64_t ticket = tail_.fetch_add(1, std::memory_order_seq_cst);
      if (ticket >= places_.size()) return false;
      std::uint64_t seen = nothing;
      // (2) release: pairs with (5), so that the task is read as written. relaxed on failure: the
      // place is spoilt, whoever did it
      if (place_of(ticket).compare_exchange_strong(seen, word, std::memory_order_release,
                                                   std::memory_order_relaxed))
        return true;
    }
  }

  /// Takes the oldest word; false if there is none. Lock-free.
  bool take(unsigned /*worker*/, std::uint64_t& word) {
    for (;;) {
      // The head before the tail: so at some moment every ticket of a push had been popped.
      const std::uint64_t head = head_.load(std::memory_order_seq_cst);
      // (3) seq_cst: pairs with (1); an old tail would let us answer *empty* too early
      const std::uint64_t tail = tail_.load(std::memory_order_seq_cst);
      if (head >= std::min<std::uint64_t>(tail, places_.size())) return false;
      // (4) acq_rel: pairs with the one of the ticket before, and with the links of
      // linked_rings.hpp. A pop that began after a push had returned may have overtaken this one;
      // who has a later ticket must not miss that push
      const std::uint64_t ticket = head_.fetch_add(1, std::memory_order_acq_rel);
      if (ticket >= places_.size()) return false;
      // (5) acquire: pairs with (2)
      word = place_of(ticket).exchange(taken, std::memory_order_acquire);
      if (word != nothing) return true;
    }
  }

  /// The same: each ticket is a push's or spoilt.
  bool take_rest(unsigned worker, std::uint64_t& word) { return take(worker, word); }

 private:
  // Eight places share a line of 64 bytes, so tickets that follow each other are eight places
  // apart.
  std::atomic<std::uint64_t>& place_of(std::uint64_t ticket) {
    const std::uint64_t mask = places_.size() - 1;
    return places_[(8 * ticket + (ticket >> (std::max(bits_, 3U) - 3))) & mask];
  }

  unsigned bits_;
  std::vector<std::atomic<std::uint64_t>> places_;
  alignas(cache_line_pair) std::atomic<std::uint64_t> head_{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> tail_{0};
};

template <class T>
class FaaArrayQueue : public LinkedRings<T, UsedOnceArray> {
 public:
  static constexpr std::string_view summary =
      "FAAArrayQueue: linked arrays used once, fetch-and-add, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .all_ones_reserved = true,
                                 .reserved = {0}};
  using LinkedRings<T, UsedOnceArray>::LinkedRings;
};

}  // namespace irt
