/// MultiFIFO: twice as many ring buffers as workers, each under a lock of its own, with elements
/// that know when they were pushed; a pop takes the older of two rings' first elements (Koch,
/// Sanders and Williams 2025, "BlockFIFO & MultiFIFO: Scalable Relaxed Queues", arXiv 2507.22764;
/// a MultiQueue of FIFO queues: Rihani, Sanders and Dementiev 2015, "MultiQueues: Simple Relaxed
/// Concurrent Priority Queues", SPAA).
///
/// When to use: many cores push and pop at once, an order that holds on average is enough, and
/// elements are large or own memory. When not: a bound on the order must hold in every case; a
/// thread may be stopped inside a lock, for then the elements of that ring are out of reach;
/// threads poll a queue that is mostly empty, for each *empty* asks every ring.
///
/// Ordering: none that is certain. With n rings and workers that stay with their choice for s
/// operations, an element leaves before fewer than s n older ones on average, however many are
/// inside; here n is twice the number of workers and s is 16. Progress: blocking, though nobody
/// waits for a lock while there are rings that are neither full nor empty. Memory: the rings,
/// allocated once; each is as long as its share of the capacity, rounded up to a power of two, so
/// that they hold up to twice as much in all. Bounded; *full* and *empty* say what was found in one
/// ring after the other.
///
/// How it works: a worker chooses two rings at random. A push goes into either one, a pop takes
/// from the one whose first element is the older, which shows without the lock. Where the lock is
/// taken the worker chooses two others, and does so anyway after every 16 operations. Who finds a
/// ring full, or both empty, asks all rings in turn, and there waits for locks.
///
/// What differs from the paper, and why:
/// - Who asks all rings in turn waits for their locks. To pass a ring whose lock is taken, as the
///   authors' program does, would mean *full* beside free places and *empty* beside elements.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class MultiFifoQueue {
 public:
  static constexpr std::string_view summary =
      "MultiFIFO: rings with try-locks, the older of two first elements";
  static constexpr Claims claims{.ordering = Ordering::unordered,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  MultiFifoQueue(unsigned workers, std::size_t capacity)
      : rings_(std::size_t{rings_for_each_worker} * workers), workers_(workers) {
    const std::size_t share = (capacity + rings_.size() - 1) / rings_.size();
    for (Ring& ring : rings_)
      ring.places = std::vector<Place>(std::bit_ceil(std::max<std::size_t>(share, 1)));
    for (unsigned worker = 0; worker < workers; ++worker)
      workers_[worker].random = SplitMix(worker);
  }

  /// Adds `task` to a ring; false if all were found full, one after the other. Blocking.
  bool push(unsigned worker, T task) {
    Worker& mine = workers_[worker];
    for (;;) {
      Ring& ring = *chosen(mine)[mine.random.below(2)];
      const std::unique_lock lock(ring.lock, std::try_to_lock);
      if (lock.owns_lock()) {
        if (put(ring, task)) return true;
        break;
      }
      mine.stays_for = 0;
    }
    mine.stays_for = 0;
    for (Ring& ring : rings_) {
      const std::lock_guard lock(ring.lock);
      if (put(ring, task)) return true;
    }
    return false;
  }

  /// Takes the oldest task of a ring; false if all were found empty, one after the other. Blocking.
  bool pop(unsigned worker, T& task) {
    Worker& mine = workers_[worker];
    for (;;) {
      const auto& [a, b] = chosen(mine);
      // relaxed, twice and below: a guess that is confirmed under the lock. That a ring was empty
      // is told by the last push or pop there that is seen; what is not is in flight
      const std::int64_t of_a = a->oldest.load(std::memory_order_relaxed);
      const std::int64_t of_b = b->oldest.load(std::memory_order_relaxed);
      if (of_a == nothing && of_b == nothing) break;
      Ring& ring = of_b < of_a ? *b : *a;
      const std::unique_lock lock(ring.lock, std::try_to_lock);
      if (lock.owns_lock()) {
        if (take(ring, task)) return true;
        break;
      }
      mine.stays_for = 0;
    }
    mine.stays_for = 0;
    for (Ring& ring : rings_) {
      // relaxed: as above
      if (ring.oldest.load(std::memory_order_relaxed) == nothing) continue;
      const std::lock_guard lock(ring.lock);
      if (take(ring, task)) return true;
    }
    return false;
  }

 private:
  static constexpr unsigned rings_for_each_worker = 2;
  static constexpr unsigned stickiness = 16;
  static constexpr std::int64_t nothing = INT64_MAX;  // later than all times

  class TryLock {
   public:
    bool try_lock() {
      // relaxed: a guess that saves the line from being written
      // (1) acquire: pairs with (2), so that we see what the last owner wrote
      return !taken_.load(std::memory_order_relaxed) &&
             !taken_.exchange(true, std::memory_order_acquire);
    }
    void lock() {
      for (unsigned looks = 0; !try_lock(); ++looks) {
        if (looks < 64)
          pause();
        else
          std::this_thread::yield();
      }
    }
    void unlock() {
      // (2) release: pairs with (1)
      taken_.store(false, std::memory_order_release);
    }

   private:
    static void pause() {
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }

    std::atomic<bool> taken_{false};
  };

  struct Place {
    std::int64_t pushed_at = 0;
    T task{};
  };

  struct alignas(cache_line_pair) Ring {
    TryLock lock;
    std::atomic<std::int64_t> oldest{nothing};  // when the first element was pushed
    std::size_t pushed = 0;
    std::size_t popped = 0;
    std::vector<Place> places;

    Place& at(std::size_t ticket) { return places[ticket & (places.size() - 1)]; }
  };

  struct alignas(cache_line_pair) Worker {
    SplitMix random{0};
    std::array<Ring*, 2> rings{};
    unsigned stays_for = 0;
  };

  // The two rings of the operation at hand.
  std::array<Ring*, 2>& chosen(Worker& mine) {
    if (mine.stays_for == 0) {
      const std::size_t a = mine.random.below(rings_.size());
      const std::size_t b = a + 1 + mine.random.below(rings_.size() - 1);
      mine.rings = {&rings_[a], &rings_[b % rings_.size()]};
      mine.stays_for = stickiness;
    }
    --mine.stays_for;
    return mine.rings;
  }

  // Both with the ring's lock.
  bool put(Ring& ring, T& task) {
    if (ring.pushed - ring.popped == ring.places.size()) return false;
    Place& place = ring.at(ring.pushed);
    place.task = std::move(task);
    place.pushed_at = std::chrono::steady_clock::now().time_since_epoch().count();
    // relaxed: the time alone is read without the lock
    if (ring.pushed == ring.popped) ring.oldest.store(place.pushed_at, std::memory_order_relaxed);
    ++ring.pushed;
    return true;
  }
  bool take(Ring& ring, T& task) {
    if (ring.pushed == ring.popped) return false;
    task = std::move(ring.at(ring.popped).task);
    ++ring.popped;
    // relaxed: as in put()
    ring.oldest.store(ring.pushed == ring.popped ? nothing : ring.at(ring.popped).pushed_at,
                      std::memory_order_relaxed);
    return true;
  }

  std::vector<Ring> rings_;
  std::vector<Worker> workers_;
};

}  // namespace irt
