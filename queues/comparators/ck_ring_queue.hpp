/// Concurrency Kit's `ck_ring` for many producers and consumers.
///
/// When to use: as a plain bounded ring from C. When not: producers may be stopped; who has the
/// next place waits until the one before has filled its own.
///
/// Ordering: FIFO by happens-before. Progress: push blocking, pop lock-free. Memory: `capacity`
/// places rounded up to a power of two, allocated once. Bounded; *full* counts the places that
/// pushes in flight have reserved, *empty* does not.
///
/// How it works: producers reserve places by compare-and-swap, fill them, and then raise a second
/// counter one after the other in the order of their places. A pop reads the place first and then
/// claims it by compare-and-swap.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <memory>
#include <new>
#include <string_view>

#include "queues/comparators/concurrency_kit.h"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

namespace detail {

/// A ring with the library's functions for those who push and those who pop.
template <class T, bool (*push_word)(irt_ck_ring*, std::uint64_t),
          bool (*pop_word)(irt_ck_ring*, std::uint64_t*)>
class CkRing {
 public:
  // One place always stays free.
  CkRing(unsigned /*workers*/, std::size_t capacity)
      : ring_(irt_ck_ring_new(
            static_cast<unsigned>(std::bit_ceil(std::max<std::size_t>(capacity + 1, 4))))) {
    if (ring_ == nullptr) throw std::bad_alloc();
  }

  /// Adds `task`; false if the ring is full. Blocking where many push, else wait-free.
  bool push(unsigned /*worker*/, T task) { return push_word(ring_.get(), word_of(task)); }

  /// Takes the oldest task; false if it sees none. Lock-free; wait-free for one consumer.
  bool pop(unsigned /*worker*/, T& task) {
    std::uint64_t word = 0;
    if (!pop_word(ring_.get(), &word)) return false;
    task = element_of<T>(word);
    return true;
  }

 private:
  struct Delete {
    void operator()(irt_ck_ring* ring) const { irt_ck_ring_delete(ring); }
  };

  std::unique_ptr<irt_ck_ring, Delete> ring_;
};

}  // namespace detail

template <class T>
class CkRingQueue : public detail::CkRing<T, irt_ck_ring_push, irt_ck_ring_pop> {
 public:
  static constexpr std::string_view summary = "Concurrency Kit ck_ring";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .full = Answer::calls_in_flight,
                                 .reclamation = Reclamation::preallocated};
  using detail::CkRing<T, irt_ck_ring_push, irt_ck_ring_pop>::CkRing;
};

/// For one producer.
template <class T>
class CkRingSpmcQueue : public detail::CkRing<T, irt_ck_ring_push_spmc, irt_ck_ring_pop_spmc> {
 public:
  static constexpr std::string_view summary = "Concurrency Kit ck_ring, one producer";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .reclamation = Reclamation::preallocated};
  using detail::CkRing<T, irt_ck_ring_push_spmc, irt_ck_ring_pop_spmc>::CkRing;
};

/// For one consumer.
template <class T>
class CkRingMpscQueue : public detail::CkRing<T, irt_ck_ring_push_mpsc, irt_ck_ring_pop_mpsc> {
 public:
  static constexpr std::string_view summary = "Concurrency Kit ck_ring, one consumer";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .pop = Progress::wait_free,
                                 .bounded = true,
                                 .full = Answer::calls_in_flight,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};
  using detail::CkRing<T, irt_ck_ring_push_mpsc, irt_ck_ring_pop_mpsc>::CkRing;
};

}  // namespace irt
