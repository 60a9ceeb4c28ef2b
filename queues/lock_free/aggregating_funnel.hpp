/// Aggregating funnels: a fetch-and-add that many threads can share (Roh, Wei, Ruppert, Fatourou,
/// Jayanti and Shun 2025, "Aggregating Funnels for Faster Fetch&Add and Queues", PPoPP), as the
/// tickets of `ClosableRing`.
///
/// When to use: so many cores draw tickets at once that the line of the counter moves all the time,
/// some eighty of today's. When not: fewer; a ticket costs two fetch-and-adds and a wait. Threads
/// are stopped in the midst of calls, for then others wait for them.
///
/// Progress: blocking. Memory: with p workers and so sqrt(p) aggregators, two kilobytes for each
/// and a pair of cache lines for each worker.
///
/// How it works: the workers are dealt out to aggregators, about sqrt(p) to each. Who wants a
/// ticket adds one to its aggregator's count. The first that comes after a batch is the next
/// batch's delegate: it reads the count, adds as many as have come to the counter proper, all at
/// once, and writes down where the batch begins there. The others wait for that and work out their
/// own tickets from it. So both the counter and an aggregator are shared by sqrt(p) threads only,
/// and a member meets two lines: the count and the last batch.
///
/// What differs from the paper, and why:
/// - Tickets are taken one at a time and never given back, so that there are no negative
/// aggregators.
/// - The paper links the batches of an aggregator and reclaims them by epochs. Here the last ones
///   stand in a ring, for members that come too late to see their batch as the last. Before it
///   asks, and while it waits, a worker writes down which batch is the last, so that the delegate
///   that is about to write over a batch sees who may still have to read it, and waits. It looks
///   only once for many batches.
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

/// `batches_each`, at least 2: how many batches an aggregator keeps.
template <std::size_t batches_each = 64>
class AggregatedTickets {
 public:
  explicit AggregatedTickets(unsigned workers)
      : workers_each_(square_root(workers)),
        aggregators_((workers + workers_each_ - 1) / workers_each_),
        asking_(workers) {}

  /// Of all workers one after the other. Blocking. At least as strong as sequentially consistent,
  /// whatever order is asked for.
  std::uint64_t take(unsigned worker, std::memory_order /*order*/) {
    Aggregator& mine = aggregators_[worker / workers_each_];
    std::atomic<std::uint64_t>& from = asking_[worker].from;
    // (9) acquire: here and below; pairs with (10): who sees a batch's place sees the end of the
    // one before, and was served by none before it
    std::uint64_t place = mine.last.place.load(std::memory_order_acquire);
    // relaxed: (1) publishes it
    from.store(place, std::memory_order_relaxed);
    // (1) acq_rel: pairs with (3); what this worker did before, what it wrote down too, is known to
    // whoever serves it
    const std::uint64_t number = mine.asked.fetch_add(1, std::memory_order_acq_rel);
    for (Pace pace;; pace.wait()) {
      // As (9) acquire: says.
      const std::uint64_t latest = mine.last.place.load(std::memory_order_acquire);
      // (2) acquire: pairs with (5), so that the batch is read as written
      const std::uint64_t served = mine.last.end.load(std::memory_order_acquire);
      if (served < number) {
        // relaxed: an older one is as good, for a while
        if (latest != place) from.store(place = latest, std::memory_order_relaxed);
        continue;
      }
      if (served == number) {
        // relaxed: it reads no batch
        from.store(nothing, std::memory_order_relaxed);
        return serve(mine, number);
      }
      const std::uint64_t ticket = read(mine, number);
      // (6) release: pairs with (4), so that the batch is written over after it was read
      from.store(nothing, std::memory_order_release);
      return ticket;
    }
  }

  alignas(cache_line_pair) std::atomic<std::uint64_t> next{0};

 private:
  static constexpr std::uint64_t nothing = ~std::uint64_t{0};

  /// Of the numbers from `begin` to before `end`: the tickets from `ticket` on. Batches are
  /// counted, and stand at that `place` of the ring.
  struct Batch {
    std::atomic<std::uint64_t> begin{0};
    std::atomic<std::uint64_t> end{0};
    std::atomic<std::uint64_t> ticket{0};
    std::atomic<std::uint64_t> place{0};
  };

  struct Aggregator {
    alignas(cache_line_pair) std::atomic<std::uint64_t> asked{0};
    alignas(cache_line_pair) Batch last;
    alignas(cache_line_pair) std::uint64_t unread = 0;  // batches from this place on may be
    std::array<Batch, batches_each> batches;
  };

  /// The place of the first batch that a worker may have to read, or nothing.
  struct alignas(cache_line_pair) Asking {
    std::atomic<std::uint64_t> from{nothing};
  };

  /// Of a thread that waits for another: gives way to it now and then.
  struct Pace {
    unsigned looks = 0;
    void wait() {
      pause();
      if (++looks % 64 == 0) std::this_thread::yield();
    }
  };

  // Rounded up, so that two workers share an aggregator.
  static unsigned square_root(unsigned number) {
    unsigned root = 1;
    while (root * root < number) ++root;
    return root;
  }

  // Fetches the tickets of all who have asked from `number` on; returns the first.
  std::uint64_t serve(Aggregator& mine, std::uint64_t number) {
    // relaxed: written by the delegate before, whom (2) has seen
    const std::uint64_t place = mine.last.place.load(std::memory_order_relaxed) + 1;
    if (place - mine.unread >= batches_each) await_readers(mine, place);
    // (3) acquire: pairs with (1)
    const std::uint64_t end = mine.asked.load(std::memory_order_acquire);
    const std::uint64_t ticket = next.fetch_add(end - number, std::memory_order_seq_cst);
    write(mine.batches[place % batches_each], number, ticket, place, end);
    write(mine.last, number, ticket, place, end);
    return ticket;
  }

  static void write(Batch& batch, std::uint64_t begin, std::uint64_t ticket, std::uint64_t place,
                    std::uint64_t end) {
    // (10) release: pairs with (9)
    batch.place.store(place, std::memory_order_release);
    // relaxed: (7) publishes it
    batch.begin.store(begin, std::memory_order_relaxed);
    // (7) release: pairs with (8), so that who sees the ticket sees where its batch begins
    batch.ticket.store(ticket, std::memory_order_release);
    // (5) release: pairs with (2) and (8)
    batch.end.store(end, std::memory_order_release);
  }

  // Waits until the batch that stood at `place` is not needed any more, and learns how many are
  // not.
  void await_readers(Aggregator& mine, std::uint64_t place) {
    const auto first = static_cast<std::size_t>(&mine - aggregators_.data()) * workers_each_;
    const auto last = std::min<std::size_t>(first + workers_each_, asking_.size());
    for (Pace pace; place - mine.unread >= batches_each; pace.wait()) {
      mine.unread = place;
      for (std::size_t worker = first; worker < last; ++worker)
        // (4) acquire: pairs with (6). Who asked for a batch before this one had written down where
        // by then, and its delegate has seen it
        mine.unread = std::min(mine.unread, asking_[worker].from.load(std::memory_order_acquire));
    }
  }

  // The ticket of `number`, which has been fetched: in the last batch or one not long before, which
  // nobody writes over until it is read.
  std::uint64_t read(Aggregator& mine, std::uint64_t number) {
    // relaxed: (2) has seen this batch, or a later one
    std::uint64_t place = mine.last.place.load(std::memory_order_relaxed);
    for (Batch* batch = &mine.last;; batch = &mine.batches[place-- % batches_each]) {
      // (8) acquire: twice; pairs with (5) and (7)
      const std::uint64_t end = batch->end.load(std::memory_order_acquire);
      const std::uint64_t ticket = batch->ticket.load(std::memory_order_acquire);
      // relaxed: after (8). Written first, so that an old one means that all of it was
      const std::uint64_t begin = batch->begin.load(std::memory_order_relaxed);
      if (begin <= number && number < end) return ticket + (number - begin);
    }
  }

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  static_assert(batches_each >= 2, "of one batch, members could not wait for the next");

  // What nobody writes, apart from what all do.
  alignas(cache_line_pair) const unsigned workers_each_;
  std::vector<Aggregator> aggregators_;
  std::vector<Asking> asking_;
};

}  // namespace irt
