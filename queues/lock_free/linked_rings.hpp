/// A list of rings, each of which takes elements until it is closed for good: how LCRQ (Morrison
/// and Afek 2013, "Fast Concurrent Queues for x86 Processors", PPoPP, section 4.2) makes an
/// unbounded queue of bounded ones, and after it FAAArrayQueue, LSCQ and LPRQ.
///
/// When to use: a ring is fast, but bounded, or may have to give itself up. When not: the ring is
/// bounded and that will do; a list needs reclamation and an allocator.
///
/// Ordering, progress: the ring's, apart from the allocator. Memory: a ring, and one more when it
/// is closed; a ring that was left waits for hazard pointers, see there for the bound. Unbounded. A
/// smaller `capacity`, rounded up to a power of two, makes smaller rings.
///
/// How it works: a push whose ring is closed links a new ring behind it, which has the element
/// already, and moves `tail_` there, or lets any other thread do it. A pop that finds its ring
/// empty and a next one linked looks once more, since between the two pushes may have filled the
/// ring and closed it, and then moves `head_` on. A worker's hazard pointer goes on naming the ring
/// it used last, so that only the first operation on a ring pays the barrier.
///
/// A ring has
///
///     std::atomic<Ring*> next{nullptr};
///     Ring(unsigned bits, unsigned workers);           // 2^bits places, at least two
///     void put_first(std::uint64_t word);              // while nobody else knows the ring
///     bool put(unsigned worker, std::uint64_t word);   // at the back; false once it is closed
///     bool take(unsigned worker, std::uint64_t& word); // the oldest; false if it sees none
///     bool take_rest(unsigned worker, std::uint64_t& word);  // once closed: false only for good
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/word.hpp"

namespace irt {

template <class T, class Ring>
class LinkedRings {
 public:
  /// Of the longest ring. The paper of LCRQ measures with 2^17, two megabytes. 2^12 still stay in a
  /// core's second cache, and a new ring of them costs little beside the pushes that fill it.
  static constexpr std::size_t most_places = 4096;

  LinkedRings(unsigned workers, std::size_t capacity)
      : bits_(static_cast<unsigned>(
            std::bit_width(std::clamp<std::size_t>(capacity, 2, most_places) - 1))),
        workers_(workers),
        hazards_(workers, 1),
        used_(workers),
        head_(new Ring(bits_, workers_)),
        // relaxed: construction is single-threaded
        tail_(head_.load(std::memory_order_relaxed)) {}
  LinkedRings(const LinkedRings&) = delete;
  LinkedRings& operator=(const LinkedRings&) = delete;

  ~LinkedRings() {
    // relaxed, twice: destruction is single-threaded
    Ring* ring = head_.load(std::memory_order_relaxed);
    while (ring != nullptr) {
      Ring* next = ring->next.load(std::memory_order_relaxed);
      delete ring;
      ring = next;
    }
  }

  /// Adds `task` at the back. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    std::unique_ptr<Ring> fresh;
    for (;;) {
      Ring* ring = protect<at_tail>(worker, tail_);
      // (1) seq_cst: pairs with (2), so that a ring we move `tail_` to is whole for who reads it
      // there, and what we push into it comes behind that link in the order of all
      Ring* next = ring->next.load(std::memory_order_seq_cst);
      if (next != nullptr) {
        move(tail_, ring, next);
        continue;
      }
      if (ring->put(worker, word_of(task))) return true;
      if (fresh == nullptr) {
        fresh = std::make_unique<Ring>(bits_, workers_);
        fresh->put_first(word_of(task));
      }
      // (2) seq_cst: pairs with (1) and (3), so that the ring is whole for who goes on there, and a
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
      Ring* ring = protect<at_head>(worker, head_);
      if (ring->take(worker, word)) break;
      // (3) seq_cst: pairs with (2), and with the tickets of pops for order among them. Who sees a
      // ring here sees `ring` closed, too
      Ring* next = ring->next.load(std::memory_order_seq_cst);
      if (next == nullptr) return false;
      if (ring->take_rest(worker, word)) break;
      // `tail_` must have left `ring` before `head_` does, or a push would find it freed
      move(tail_, ring, next);
      if (move(head_, ring, next)) hazards_.guard(worker).retire(ring);
    }
    task = element_of<T>(word);
    return true;
  }

 private:
  enum Place : std::size_t { at_head, at_tail };

  struct alignas(cache_line_pair) Used {
    std::array<Ring*, 2> ring{};
  };

  // The ring in `source`. One that our hazard pointer names since an earlier call has been safe
  // ever since, which only hazard pointers promise.
  template <Place place>
  Ring* protect(unsigned worker, const std::atomic<Ring*>& source) {
    Ring*& used = used_[worker].ring[place];
    // relaxed: a ring that was left is closed, and says where to go on
    if (source.load(std::memory_order_relaxed) != used)
      used = hazards_.guard(worker).template protect<place>(source);
    return used;
  }

  static bool move(std::atomic<Ring*>& source, Ring* from, Ring* to) {
    // (4) release: pairs with the load in protect() of hazard_pointers.hpp, so that `to` is whole
    // for who reads it there; and with the fence there, which is what retire() asks for. relaxed on
    // failure: another thread has done it
    return source.compare_exchange_strong(from, to, std::memory_order_release,
                                          std::memory_order_relaxed);
  }

  const unsigned bits_;
  const unsigned workers_;
  HazardPointers<Ring, 2> hazards_;
  std::vector<Used> used_;
  // Initialised by the constructor: where a `new` in a member's own initialiser throws, GCC 12 does
  // not give the memory back.
  alignas(cache_line_pair) std::atomic<Ring*> head_;
  alignas(cache_line_pair) std::atomic<Ring*> tail_;
};

}  // namespace irt
