/// The MCS lock: a list of waiters, each of which looks at a line of its own (Mellor-Crummey and
/// Scott 1991, "Algorithms for Scalable Synchronization on Shared-Memory Multiprocessors", ACM
/// TOCS).
///
/// When to use: many cores wait for one lock; a release then takes a line from one of them, not
/// from all. When not: hardly anybody waits, for giving it back costs a compare-and-swap where a
/// ticket lock stores; or more threads than cores, for the lock goes to the thread whose turn it
/// is, also while that has no core.
///
/// Order: first come, first served. Progress: blocking. Memory: a word; a node for each who holds
/// it or waits, in its guard.
///
/// How it works: who comes makes itself the last of the list and, if there was one before it, links
/// itself behind that one and waits to be told. Who goes tells the next. Where none is linked it
/// takes itself out as the last; if it is not the last any more, the next is about to be linked.
///
/// What differs from the paper, and why:
/// - The node is the guard, where the paper hands a node to both `acquire` and `release`. So there
///   is no way to lock without one, or to unlock with another.
/// - Nodes are not padded: nobody else writes near one whose owner waits.
#pragma once

#include <atomic>

#include "queues/blocking/spin_until.hpp"

namespace irt {

class McsLock {
 public:
  /// Holds a lock as long as it lives. All locks of this folder have one.
  class Guard {
   public:
    /// Blocking.
    explicit Guard(McsLock& lock) : lock_(lock) {
      // relaxed, twice: (1) and (2) publish the node
      next_.store(nullptr, std::memory_order_relaxed);
      waits_.store(true, std::memory_order_relaxed);
      // (1) acq_rel: pairs with (5), so that we see what the last holder wrote; and with this very
      // line of mcs_lock.hpp in the next guard, so that our node is whole when it links itself here
      Guard* before = lock_.last_.exchange(this, std::memory_order_acq_rel);
      if (before == nullptr) return;
      // (2) release: pairs with (4) and (6), so that our node is whole for who tells us
      before->next_.store(this, std::memory_order_release);
      // (3) acquire: pairs with (7), so that we see what the last holder wrote
      spin_until_zero([this] { return waits_.load(std::memory_order_acquire); });
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

    /// Blocking: waits for a next one that is there and not yet linked.
    ~Guard() {
      // (4) acquire: pairs with (2)
      Guard* next = next_.load(std::memory_order_acquire);
      if (next == nullptr) {
        Guard* last = this;
        // (5) release: pairs with (1). relaxed on failure: nothing was read but a change
        if (lock_.last_.compare_exchange_strong(last, nullptr, std::memory_order_release,
                                                std::memory_order_relaxed))
          return;
        spin_until_zero([&] {
          // (6) acquire: pairs with (2), as the load above
          next = next_.load(std::memory_order_acquire);
          return next == nullptr;
        });
      }
      // (7) release: pairs with (3)
      next->waits_.store(false, std::memory_order_release);
    }

   private:
    McsLock& lock_;
    // Mutable, for others write to them, and a guard may be const.
    mutable std::atomic<Guard*> next_;
    mutable std::atomic<bool> waits_;
  };

 private:
  std::atomic<Guard*> last_{nullptr};
};

}  // namespace irt
