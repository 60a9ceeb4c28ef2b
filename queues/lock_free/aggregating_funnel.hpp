/// Aggregating funnels: a fetch-and-add that many threads can share (Roh, Wei, Ruppert, Fatourou,
/// Jayanti and Shun 2025, "Aggregating Funnels for Faster Fetch&Add and Queues", PPoPP), as the
/// tickets of `ClosableRing`.
///
/// When to use: so many cores draw tickets at once that the line of the counter moves all the time,
/// some eighty of today's. When not: fewer; a ticket costs two fetch-and-adds and a wait. Threads
/// are stopped in the midst of calls, for then others wait for them.
///
/// Progress: blocking. Memory: with p workers and so sqrt(p) aggregators, some kilobytes for each.
///
/// How it works: the workers are dealt out to aggregators, about sqrt(p) to each. Who wants a
/// ticket adds one to its aggregator's count. The first that comes after a batch is the next
/// batch's delegate: it reads the count, adds as many as have come to the counter proper, all at
/// once, and writes down where the batch begins there. The others wait for that and work out their
/// own tickets from it. So both the counter and an aggregator are shared by sqrt(p) threads only.
///
/// What differs from the paper, and why:
/// - Tickets are taken one at a time and never given back, so that there are no negative
/// aggregators.
/// - The paper links the batches of an aggregator and reclaims them by epochs. Here they stand in a
///   ring, and one is written over when all its members have read it; a member that is stopped
///   before it does holds up its aggregator after so many batches as the ring has.
/// - No thread goes to the counter directly.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "queues/cache_line.hpp"

namespace irt {

class AggregatedTickets {
 public:
  explicit AggregatedTickets(unsigned workers)
      : workers_each_(square_root(workers)),
        aggregators_((workers + workers_each_ - 1) / workers_each_) {}

  /// Of all workers one after the other. Blocking. At least as strong as sequentially consistent,
  /// whatever order is asked for.
  std::uint64_t take(unsigned worker, std::memory_order /*order*/) {
    Aggregator& mine = aggregators_[worker / workers_each_];
    // (1) acq_rel: pairs with (2); what this worker did before is known to whoever serves it
    const std::uint64_t number = mine.asked.fetch_add(1, std::memory_order_acq_rel);
    for (unsigned looks = 1;; ++looks) {
      // (3) acquire: pairs with (5), so that the batch is read as written
      const std::uint64_t served = mine.served.load(std::memory_order_acquire);
      if (served == number) return serve(mine, number);
      if (served > number) return read(mine, number);
      pause();
      if (looks % looks_before_yield == 0) std::this_thread::yield();
    }
  }

  std::atomic<std::uint64_t> next{0};

 private:
  static constexpr unsigned looks_before_yield = 64;
  static constexpr std::size_t batches_each = 16;

  /// Of the numbers from `begin` to before `end`: the tickets from `ticket` on.
  struct Batch {
    std::atomic<std::uint64_t> begin{0};
    std::atomic<std::uint64_t> end{0};
    std::atomic<std::uint64_t> ticket{0};
    std::atomic<std::uint64_t> unread{0};  // how many members have yet to read it
  };

  struct Aggregator {
    alignas(cache_line_pair) std::atomic<std::uint64_t> asked{0};
    alignas(cache_line_pair) std::atomic<std::uint64_t> served{0};  // the end of the last batch
    std::atomic<std::uint64_t> last{0};                             // its place, counted on
    std::array<Batch, batches_each> batches;
  };

  static unsigned square_root(unsigned number) {
    unsigned root = 1;
    while ((root + 1) * (root + 1) <= number) ++root;
    return root;
  }

  // Fetches the tickets of all who have asked from `number` on; returns the first.
  std::uint64_t serve(Aggregator& mine, std::uint64_t number) {
    // relaxed: written by the delegate before, whom (3) has seen
    const std::uint64_t place = mine.last.load(std::memory_order_relaxed) + 1;
    Batch& batch = mine.batches[place % batches_each];
    // (4) acquire: pairs with (6), so that the batch is written after it was read
    for (unsigned looks = 1; batch.unread.load(std::memory_order_acquire) != 0; ++looks) {
      pause();
      if (looks % looks_before_yield == 0) std::this_thread::yield();
    }
    // (2) acquire: pairs with (1)
    const std::uint64_t end = mine.asked.load(std::memory_order_acquire);
    const std::uint64_t ticket = next.fetch_add(end - number, std::memory_order_seq_cst);
    // relaxed, three times: (5) publishes them
    batch.ticket.store(ticket, std::memory_order_relaxed);
    batch.unread.store(end - number - 1, std::memory_order_relaxed);
    batch.begin.store(number, std::memory_order_relaxed);
    // (7) release: pairs with (8), so that who sees the end of this batch sees its beginning
    batch.end.store(end, std::memory_order_release);
    // relaxed: (5) publishes it
    mine.last.store(place, std::memory_order_relaxed);
    // (5) release: pairs with (3)
    mine.served.store(end, std::memory_order_release);
    return ticket;
  }

  // The ticket of `number`, which has been fetched: in the last batch or one not long before, which
  // nobody writes over until it is read.
  std::uint64_t read(Aggregator& mine, std::uint64_t number) {
    // relaxed: (3) has seen the batch, or a later one
    for (std::uint64_t place = mine.last.load(std::memory_order_relaxed);; --place) {
      Batch& batch = mine.batches[place % batches_each];
      // (8) acquire: pairs with (7). relaxed: the beginning is that of this end, or of a later
      // batch
      if (batch.end.load(std::memory_order_acquire) <= number) continue;
      const std::uint64_t begin = batch.begin.load(std::memory_order_relaxed);
      if (begin > number) continue;
      // relaxed: written before the end was
      const std::uint64_t ticket = batch.ticket.load(std::memory_order_relaxed);
      // (6) release: pairs with (4)
      batch.unread.fetch_sub(1, std::memory_order_release);
      return ticket + (number - begin);
    }
  }

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  const unsigned workers_each_;
  std::vector<Aggregator> aggregators_;
};

}  // namespace irt
