/// Quiescent states (QSBR; Hart, McKenney, Demke Brown and Walpole 2007, "Performance of Memory
/// Reclamation for Lockless Synchronization", JPDC): between its operations a worker holds no node,
/// and says so now and then instead of saying when it does.
///
/// When to use: workers come back to the structure all the time. An operation pays one look at a
/// line that seldom changes, no barrier. When not: a worker stays away for long and cannot `leave`;
/// until it comes back nothing is freed by anybody. A task that takes a second keeps a second's
/// nodes. So does a thread that stands still inside an operation.
///
/// Progress: all methods take a bounded number of steps apart from what they free. Memory: what was
/// retired in three epochs. While nobody stays away, a worker ends an epoch with every `batch`
/// retired nodes, once all others have ended an operation in it. A worker that has left holds
/// nobody back; one that neither calls nor leaves holds back all, however long.
///
/// How it works: a worker that ends an operation looks at the epoch and, where it is a new one,
/// writes it down as seen. The epoch moves on once all workers that have not left have seen it. A
/// node that was retired in an epoch is out of reach for who has seen the one after the next: by
/// then the worker that unlinked it had said, too, that it had seen a later one. So one epoch more,
/// and nobody is left who could have come to it before. All of this is acquire and release. Only
/// who comes in, at the first operation and after `leave`, makes Dekker's pattern with who finds it
/// away, and needs a fence.
///
/// What differs from the paper, and why:
/// - The paper leaves open how epochs are kept. As in epochs.hpp each worker has three bags of
/// nodes
///   that are linked through themselves.
/// - Who looks whether all others have seen the epoch resumes where it last found one that had not.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/full_fence.hpp"
#include "queues/reclamation/limbo.hpp"
#include "queues/reclamation/reclaimer.hpp"

namespace irt {

template <class Node, template <class> class Nodes = HeapNodes>
class QuiescentStates {
  using Linked = LinkedNode<Node>;

 public:
  static constexpr Offers offers{.nodes = any_number, .follows_retired = true};

  /// `batch` retired nodes make a bag full.
  QuiescentStates(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)), nodes_(workers, batch_), workers_(workers) {}
  QuiescentStates(const QuiescentStates&) = delete;
  QuiescentStates& operator=(const QuiescentStates&) = delete;

  ~QuiescentStates() {
    for (Worker& worker : workers_)
      for (int bags = 0; bags < 3; ++bags) free(0, worker.limbo.change());
  }

  /// Between one guard's end and the next one's begin a worker is quiescent.
  class Guard : public ProtectsAll<Node> {
   public:
    Guard(QuiescentStates& all, unsigned worker) : all_(all), worker_(worker) {
      Worker& mine = all_.workers_[worker_];
      if (mine.epoch == away) all_.come(mine);
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    ~Guard() { all_.rest(worker_); }

    /// The node that `source` holds. Wait-free.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      // (1) acquire: pairs with the releases that move head and tail in michael_scott_queue.hpp
      return source.load(std::memory_order_acquire);
    }

    /// Frees `node` in the third epoch from now. Wait-free.
    void retire(Node* node) const { all_.workers_[worker_].limbo.add(static_cast<Linked*>(node)); }

   private:
    QuiescentStates& all_;
    unsigned worker_;
  };

  [[nodiscard]] Guard guard(unsigned worker) { return {*this, worker}; }

  /// The worker makes no guard for long. Wait-free.
  void leave(unsigned worker) {
    Worker& mine = workers_[worker];
    mine.epoch = away;
    // (2) release: pairs with (6) and (7), so that what this worker read was read before it is
    // freed, and what it unlinked is out of reach
    mine.seen.store(away, std::memory_order_release);
  }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    return nodes_.make(worker, std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, static_cast<Linked*>(node)); }

 private:
  static constexpr std::uint64_t away = 0;  // no epoch

  struct alignas(cache_line_pair) Worker {
    std::atomic<std::uint64_t> seen{away};
    // The worker's own:
    std::uint64_t epoch = away;  // the same
    std::size_t others = 0;      // so many workers have seen it, as far as this one has looked
    Limbo<Linked> limbo;
  };

  void come(Worker& mine) {
    // relaxed, twice: the fence orders both
    mine.seen.store(epoch_.load(std::memory_order_relaxed), std::memory_order_relaxed);
    // Pairs with the one in look(): what who misses that this worker has come had seen unlinked, it
    // cannot come to; and the epoch that it reads now is no earlier than theirs.
    full_fence();
    see(mine);
  }

  // At the end of an operation.
  void rest(unsigned worker) {
    Worker& mine = workers_[worker];
    if (mine.limbo.fresh() >= batch_) look(mine);
    // relaxed: see() looks again
    if (epoch_.load(std::memory_order_relaxed) == mine.epoch) return;
    see(mine);
    free(worker, mine.limbo.change());
  }

  void see(Worker& mine) {
    // (3) acquire: pairs with (5), so that what was unlinked in the epochs that are over is out of
    // reach from now on, and what others read in them was read before it is freed
    mine.epoch = epoch_.load(std::memory_order_acquire);
    mine.others = 0;
    // (4) release: pairs with (6) and (7), for the same end as where a worker leaves
    mine.seen.store(mine.epoch, std::memory_order_release);
  }

  // Moves the epoch on if everybody who is here has seen it.
  void look(Worker& mine) {
    for (; mine.others < workers_.size(); ++mine.others) {
      const std::atomic<std::uint64_t>& other = workers_[mine.others].seen;
      // (6) acquire: pairs with (2) and (4)
      std::uint64_t seen = other.load(std::memory_order_acquire);
      if (seen == away) {
        // Pairs with the one in come().
        full_fence();
        // (7) acquire: pairs with (2) and (4)
        seen = other.load(std::memory_order_acquire);
      }
      if (seen != away && seen != mine.epoch) return;
    }
    std::uint64_t expected = mine.epoch;
    // (5) release: pairs with (3). relaxed on failure: somebody else has done it
    epoch_.compare_exchange_strong(expected, mine.epoch + 1, std::memory_order_release,
                                   std::memory_order_relaxed);
  }

  void free(unsigned worker, Bag<Linked> bag) {
    while (Linked* node = bag.take()) nodes_.free(worker, node);
  }

  std::size_t batch_;
  Nodes<Linked> nodes_;
  std::vector<Worker> workers_;
  alignas(cache_line_pair) std::atomic<std::uint64_t> epoch_{1};
};

}  // namespace irt
