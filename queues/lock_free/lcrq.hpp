/// LCRQ: a linked list of rings whose places are given out by fetch-and-add (Morrison and Afek
/// 2013, "Fast Concurrent Queues for x86 Processors", PPoPP), with hazard pointers.
///
/// When to use: many cores push and pop at once. A fetch-and-add always succeeds, so nobody repeats
/// what others made fail, and at its place an operation meets only its counterpart. When not:
/// threads poll a queue that is mostly empty, for each look takes a ticket and spoils a place;
/// there are many small queues, for one has a ring of up to 64 KiB; the processor has no
/// compare-and-swap of 16 bytes, for then libatomic takes a lock.
///
/// Ordering: FIFO in real time. Progress: lock-free, apart from the allocator. Memory: a ring of
/// 4,096 places of 16 bytes, and one more when it is full; a ring that was left waits for hazard
/// pointers, see there for the bound. Unbounded. A smaller `capacity`, rounded up to a power of
/// two, makes smaller rings. With fewer places than threads they close all the time.
///
/// How it works: a push takes a ticket at the ring's tail, a pop one at its head, and the two with
/// the same ticket meet at one place. The place's round is ticket / places; a push fills a place of
/// its round or an earlier one, a pop empties it and moves it on to the next round. A pop that
/// comes first waits a little, then moves the place on all the same, and its push has to take
/// another ticket. A pop that finds an element of an earlier round, whose own pop is late, cannot
/// move the place on and marks it unsafe: from then on a push may fill it only if no pop has its
/// ticket yet. A push closes the ring for good when it is full or too many tickets in a row were
/// spoilt; it then links a new ring that has its element already, and pops go on there when the old
/// one is empty.
///
/// What differs from the paper, and why:
/// - A place says that it is full by a bit of its own, so that every word can be an element. It
///   holds its round instead of its index, so that a new ring is all zeros.
/// - Places are read whole, 16 bytes at once. The paper reads one half after the other and lets the
///   compare-and-swap notice a change between them; C++ has no way to say that. On x86-64 libatomic
///   may read by a compare-and-swap, so that looking costs as much as writing. Therefore a push
///   does not look before its first try: it expects a place that was left in good order.
/// - Tickets that follow each other have places in different cache lines, where the paper has one
///   place in each line.
/// - A pop that has found the ring empty and a next one linked looks once more before it leaves:
///   between its two looks pushes may have filled the ring and closed it.
/// - A worker's hazard pointer goes on naming the ring it used last, so that only the first
///   operation on a ring pays the barrier.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The paper's CRQ: a ring of words that can be closed for pushes.
class ClosableRing {
 public:
  std::atomic<ClosableRing*> next{nullptr};

  /// 2^`bits` places; `bits` at least 1.
  explicit ClosableRing(unsigned bits) : bits_(bits), places_(std::size_t{1} << bits) {}

  /// Adds the first word of a ring that nobody else knows yet.
  void put_first(std::uint64_t word) {
    // relaxed, twice: whoever links the ring releases it
    places_[0].store(full(0, word), std::memory_order_relaxed);
    tail_.store(1, std::memory_order_relaxed);
  }

  /// Adds `word` at the back; false if the ring is closed, which it may do itself. Lock-free.
  bool put(std::uint64_t word) {
    for (std::size_t tries = std::min(places_.size(), most_tries); tries > 0; --tries) {
      // (1) seq_cst: pairs with (3), so that a pop that begins later sees that there was a push
      const std::uint64_t ticket = tail_.fetch_add(1, std::memory_order_seq_cst);
      if ((ticket & closed) != 0) return false;
      if (fill(ticket, word)) return true;
      // relaxed: at worst an old head closes the ring too early
      const std::uint64_t ahead = ticket - head_.load(std::memory_order_relaxed);
      if (static_cast<std::int64_t>(ahead) >= static_cast<std::int64_t>(places_.size())) break;
    }
    // relaxed: who links a ring behind this one has read the bit, and (8) tells the pops
    tail_.fetch_or(closed, std::memory_order_relaxed);
    return false;
  }

  /// Takes the oldest word; false if there is none. Lock-free.
  bool take(std::uint64_t& word) {
    for (;;) {
      // (2) acq_rel: pairs with the one of the ticket before, and with (9). A pop that began after
      // a push had returned may have overtaken this one; who has a later ticket must not miss that
      // push there
      const std::uint64_t ticket = head_.fetch_add(1, std::memory_order_acq_rel);
      if (empty(ticket, word)) return true;
      // (3) seq_cst: pairs with (1); an old tail would let us answer *empty* too early
      if ((tail_.load(std::memory_order_seq_cst) & ~closed) <= ticket + 1) {
        catch_up();
        return false;
      }
    }
  }

 private:
  struct alignas(2 * sizeof(std::uint64_t)) Place {
    std::uint64_t state = 0;  // the round above two flags
    std::uint64_t word = 0;

    [[nodiscard]] std::uint64_t round() const { return state >> 2U; }
    [[nodiscard]] bool is_full() const { return (state & 1U) != 0; }
    [[nodiscard]] bool is_unsafe() const { return (state & 2U) != 0; }
    [[nodiscard]] Place made_unsafe() const { return {state | 2U, word}; }
    [[nodiscard]] Place emptied_for(std::uint64_t round) const {
      return {round << 2U | (state & 2U), 0};
    }
  };
  using AtomicPlace = std::atomic<Place>;

  static constexpr std::uint64_t closed = std::uint64_t{1} << 63U;  // of the tail

  // So many tickets may be spoilt before a push gives the ring up; fewer where a new one is cheap.
  static constexpr std::size_t most_tries = 10;

  static Place full(std::uint64_t round, std::uint64_t word) { return {round << 2U | 1U, word}; }

  // Four places share a line of 64 bytes, so tickets that follow each other are four places apart.
  AtomicPlace& place_of(std::uint64_t ticket) {
    const std::uint64_t mask = places_.size() - 1;
    const std::uint64_t at = ticket & mask;
    return places_[(4 * at + (at >> (std::max(bits_, 2U) - 2))) & mask];
  }

  bool fill(std::uint64_t ticket, std::uint64_t word) {
    AtomicPlace& place = place_of(ticket);
    const std::uint64_t round = ticket >> bits_;
    Place seen{round << 2U, 0};
    for (;;) {
      // (4) release: pairs with (6), so that the task is read as written
      // (5) acquire: on failure; pairs with (6), so that where a pop made the place unsafe its
      // ticket is seen below
      if (place.compare_exchange_strong(seen, full(round, word), std::memory_order_release,
                                        std::memory_order_acquire))
        return true;
      if (seen.is_full() || seen.round() > round) return false;
      // relaxed: (5) says what must be seen
      if (seen.is_unsafe() && head_.load(std::memory_order_relaxed) > ticket) return false;
    }
  }

  // Takes the word of `ticket`, or sees to it that no push can leave it there any more.
  bool empty(std::uint64_t ticket, std::uint64_t& word) {
    AtomicPlace& place = place_of(ticket);
    const std::uint64_t round = ticket >> bits_;
    Place seen = await(place, ticket);
    while (seen.round() <= round) {
      const bool late = seen.is_full() && seen.round() < round;
      const Place moved = late ? seen.made_unsafe() : seen.emptied_for(round + 1);
      // (6) acq_rel: pairs with (4) to take a task, with (5) to mark a place. relaxed on failure:
      // what was read is for the next try to confirm
      if (!place.compare_exchange_strong(seen, moved, std::memory_order_acq_rel,
                                         std::memory_order_relaxed))
        continue;
      word = seen.word;
      return seen.is_full() && !late;
    }
    return false;
  }

  // What is at `place`, if possible when the push with `ticket` has been there. Waiting saves two
  // tickets, and at worst a new ring, so that a ring of more places is worth a longer wait.
  Place await(const AtomicPlace& place, std::uint64_t ticket) {
    // relaxed, here and below: what is seen is for (6) to confirm
    Place seen = place.load(std::memory_order_relaxed);
    const auto waits = [&] { return !seen.is_full() && seen.round() <= ticket >> bits_; };
    if (!waits() || (tail_.load(std::memory_order_relaxed) & ~closed) <= ticket) return seen;
    for (std::size_t looks = 1 + places_.size() / 64; looks > 0 && waits(); --looks) {
      pause();
      seen = place.load(std::memory_order_relaxed);
    }
    return seen;
  }

  // Pops have taken tickets that no push has had: moves the tail behind them.
  void catch_up() {
    // relaxed, all three: only tickets to be spoilt are saved; an old head saves fewer
    std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint64_t head = head_.load(std::memory_order_relaxed);
      if (head <= tail) return;
      if (tail_.compare_exchange_strong(tail, head, std::memory_order_relaxed)) return;
    }
  }

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  unsigned bits_;
  std::vector<AtomicPlace> places_;
  alignas(cache_line_pair) std::atomic<std::uint64_t> head_{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> tail_{0};
};

template <class T>
class Lcrq {
 public:
  static constexpr std::string_view summary =
      "LCRQ: linked rings, fetch-and-add, 16-byte CAS, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .needs_cas2 = true};

  /// Of the longest ring. The paper measures with 2^17, two megabytes. 2^12 still stay in a core's
  /// second cache, and a new ring of them costs little beside the pushes that fill it.
  static constexpr std::size_t most_places = 4096;

  Lcrq(unsigned workers, std::size_t capacity)
      : bits_(static_cast<unsigned>(
            std::bit_width(std::clamp<std::size_t>(capacity, 2, most_places) - 1))),
        hazards_(workers, 1),
        used_(workers),
        head_(new ClosableRing(bits_)),
        // relaxed: construction is single-threaded
        tail_(head_.load(std::memory_order_relaxed)) {}
  Lcrq(const Lcrq&) = delete;
  Lcrq& operator=(const Lcrq&) = delete;

  ~Lcrq() {
    // relaxed, twice: destruction is single-threaded
    ClosableRing* ring = head_.load(std::memory_order_relaxed);
    while (ring != nullptr) {
      ClosableRing* next = ring->next.load(std::memory_order_relaxed);
      delete ring;
      ring = next;
    }
  }

  /// Adds `task` at the back. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    std::unique_ptr<ClosableRing> fresh;
    for (;;) {
      ClosableRing* ring = protect(worker, at_tail, tail_);
      // (7) seq_cst: pairs with (8), so that a ring we move `tail_` to is whole for who reads it
      // there, and what we push into it comes behind that link in the order of all
      ClosableRing* next = ring->next.load(std::memory_order_seq_cst);
      if (next != nullptr) {
        move(tail_, ring, next);
        continue;
      }
      if (ring->put(word_of(task))) return true;
      if (fresh == nullptr) {
        fresh = std::make_unique<ClosableRing>(bits_);
        fresh->put_first(word_of(task));
      }
      // (8) seq_cst: pairs with (7) and (9), so that the ring is whole for who goes on there, and a
      // pop that begins later sees it. relaxed on failure: nothing was read but a change
      if (ring->next.compare_exchange_strong(next, fresh.get(), std::memory_order_seq_cst,
                                             std::memory_order_relaxed)) {
        move(tail_, ring, fresh.release());
        return true;
      }
    }
  }

  /// Takes the oldest task; false if there is none. Lock-free.
  bool pop(unsigned worker, T& task) {
    std::uint64_t word = 0;
    for (;;) {
      ClosableRing* ring = protect(worker, at_head, head_);
      if (ring->take(word)) break;
      // (9) seq_cst: pairs with (8), and with (2) for order among pops. Who sees a ring here sees
      // `ring` closed, too
      ClosableRing* next = ring->next.load(std::memory_order_seq_cst);
      if (next == nullptr) return false;
      if (ring->take(word)) break;
      // `tail_` must have left `ring` before `head_` does, or a push would find it freed
      move(tail_, ring, next);
      if (move(head_, ring, next)) hazards_.retire(worker, ring);
    }
    task = element_of<T>(word);
    return true;
  }

 private:
  enum Slot : std::size_t { at_head, at_tail };

  struct alignas(cache_line_pair) Used {
    std::array<ClosableRing*, 2> ring{};
  };

  // The ring in `source`. One that our slot names since an earlier call has been safe ever since.
  ClosableRing* protect(unsigned worker, Slot slot, const std::atomic<ClosableRing*>& source) {
    ClosableRing*& used = used_[worker].ring[slot];
    // relaxed: a ring that was left is closed, and says where to go on
    if (source.load(std::memory_order_relaxed) != used)
      used = hazards_.protect(worker, slot, source);
    return used;
  }

  static bool move(std::atomic<ClosableRing*>& source, ClosableRing* from, ClosableRing* to) {
    // (10) release: pairs with the load in protect() of hazard_pointers.hpp, so that `to` is whole
    // for who reads it there; and with the fence there, which is what retire() asks for. relaxed on
    // failure: another thread has done it
    return source.compare_exchange_strong(from, to, std::memory_order_release,
                                          std::memory_order_relaxed);
  }

  const unsigned bits_;
  HazardPointers<ClosableRing, 2> hazards_;
  std::vector<Used> used_;
  // Initialised by the constructor: where a `new` in a member's own initialiser throws, GCC 12 does
  // not give the memory back.
  alignas(cache_line_pair) std::atomic<ClosableRing*> head_;
  alignas(cache_line_pair) std::atomic<ClosableRing*> tail_;
};

}  // namespace irt
