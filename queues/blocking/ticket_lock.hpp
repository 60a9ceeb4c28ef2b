/// A ticket lock with proportional backoff (Mellor-Crummey and Scott 1991, "Algorithms for Scalable
/// Synchronization on Shared-Memory Multiprocessors", ACM TOCS).
///
/// When to use: critical sections are short, threads have a core each and are few: taking the lock
/// is one fetch-and-add, giving it back one store. When not: many cores wait, for all look at one
/// line, and each release takes it from all of them; or more threads than cores, for the lock goes
/// to the thread whose turn it is, also while that has no core.
///
/// Order: first come, first served. Progress: blocking. Memory: two words, on lines of their own.
///
/// How it works: who comes draws a ticket and waits until it is served. The distance between the
/// two numbers says how many come first, and the pause between two looks is in proportion, so that
/// the line is left to those whose turn is near.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "queues/blocking/spin_until.hpp"
#include "queues/cache_line.hpp"

namespace irt {

class TicketLock {
 public:
  /// Holds a lock as long as it lives. All locks of this folder have one.
  using Guard = std::lock_guard<TicketLock>;

  /// Blocking.
  void lock() {
    // relaxed: a ticket is given once by being a read-modify-write; (1) orders what is protected
    const std::uint32_t ticket = next_.fetch_add(1, std::memory_order_relaxed);
    spin_until_zero([&] {
      // (1) acquire: pairs with (2), so that we see what the last holder wrote
      const std::uint32_t ahead = ticket - served_.load(std::memory_order_acquire);
      return ahead == 0 ? 0 : 1 + pauses_for_each * (ahead - 1);
    });
  }

  /// Wait-free.
  void unlock() {
    // relaxed: only the holder writes it
    const std::uint32_t served = served_.load(std::memory_order_relaxed);
    // (2) release: pairs with (1)
    served_.store(served + 1, std::memory_order_release);
  }

 private:
  // For each who comes before us and does not hold the lock yet. A turn takes about as long, if not
  // longer; who misses the beginning of its own turn holds up everybody.
  static constexpr std::uint32_t pauses_for_each = 8;

  // They wrap around; what counts is how far apart they are.
  alignas(cache_line_pair) std::atomic<std::uint32_t> next_{0};
  alignas(cache_line_pair) std::atomic<std::uint32_t> served_{0};
};

}  // namespace irt
