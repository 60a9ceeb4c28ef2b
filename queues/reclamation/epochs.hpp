/// Epochs, with bags of each worker's own (Brown 2015, "Reclaiming Memory for Lock-Free Data
/// Structures: There has to be a Better Way", PODC: DEBRA; the idea is Fraser's, 2004).
///
/// When to use: operations read many nodes, or follow links of nodes that have been taken out
/// meanwhile. When not: a thread may stand still inside an operation, for then nothing is freed by
/// anybody until it goes on; that is what the lock-freedom of a structure is worth here when memory
/// is finite.
///
/// Progress: `guard` and its end take a bounded number of steps apart from what they free; all else
/// is wait-free. Memory: what was retired in three epochs. While nobody stands still inside an
/// operation, a worker ends one with the first operation after `batch` retired nodes, once all
/// others have seen it. A worker outside holds nobody back, and keeps what is in its own bags until
/// its next operations.
///
/// How it works: a worker that begins an operation announces the epoch; one that ends it takes that
/// back. The epoch moves on once all that are inside have announced it. So a node that was retired
/// in an epoch is out of reach for who announces a later one, and two moves after it nobody is left
/// who could have come to it before. A worker keeps the nodes it retired in three bags, and frees
/// the oldest whenever it finds a new epoch. To announce and then look, to unlink and then look at
/// the announcements is Dekker's pattern: here the reader has a seq_cst store and seq_cst loads,
/// the other side one fence for each bag, so that the structure itself may unlink with any order.
///
/// What differs from the paper, and why:
/// - Who looks whether all others have seen the epoch goes on from worker to worker until it finds
///   one that has not, and resumes there in its next operation. The paper looks at one worker in
///   each operation, for ever; here only workers with a full bag look.
/// - A bag is a list of the nodes themselves, where the paper has blocks of pointers. Retiring
/// takes
///   no memory, and a node is 8 bytes larger.
/// - The bags change after a fence and another look at the epoch. The paper assumes sequential
///   consistency.
/// - No signals are sent to threads that stand still (the paper's DEBRA+).
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
class Epochs {
  using Linked = LinkedNode<Node>;

 public:
  static constexpr Offers offers{.nodes = any_number, .follows_retired = true};

  /// `batch` retired nodes make a bag full.
  Epochs(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)), nodes_(workers, batch_), workers_(workers) {}
  Epochs(const Epochs&) = delete;
  Epochs& operator=(const Epochs&) = delete;

  ~Epochs() {
    for (Worker& worker : workers_)
      for (int bags = 0; bags < 3; ++bags) free(0, worker.limbo.change());
  }

  class Guard : public ProtectsAll<Node> {
   public:
    Guard(Epochs& all, unsigned worker) : all_(all), worker_(worker) { all_.enter(worker_); }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    ~Guard() {
      // (1) release: pairs with (5), so that what was read inside was read before it is freed
      all_.workers_[worker_].announced.store(outside, std::memory_order_release);
    }

    /// The node that `source` holds. Wait-free.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      // seq_cst: either this finds `source` changed, or who changed it finds the announcement
      return source.load(std::memory_order_seq_cst);
    }

    /// Frees `node` in the third epoch from now. Wait-free.
    void retire(Node* node) const { all_.workers_[worker_].limbo.add(static_cast<Linked*>(node)); }

   private:
    Epochs& all_;
    unsigned worker_;
  };

  [[nodiscard]] Guard guard(unsigned worker) { return {*this, worker}; }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    return nodes_.make(worker, std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, static_cast<Linked*>(node)); }

 private:
  static constexpr std::uint64_t outside = 0;  // no epoch

  struct alignas(cache_line_pair) Worker {
    std::atomic<std::uint64_t> announced{outside};
    // The worker's own:
    std::uint64_t epoch = 1;  // that its bags know of
    std::size_t seen = 0;     // so many workers have seen it, as far as this one has looked
    Limbo<Linked> limbo;
  };

  void enter(unsigned worker) {
    Worker& mine = workers_[worker];
    if (mine.limbo.fresh() >= batch_) look(mine);
    // relaxed: a guess that (2) confirms; or it is the epoch that (2) has read before
    if (epoch_.load(std::memory_order_relaxed) != mine.epoch) change(worker, mine);
    // (3) seq_cst: together with protect() pairs with the fence in change(), and with (5)
    mine.announced.store(mine.epoch, std::memory_order_seq_cst);
  }

  // There is a new epoch.
  void change(unsigned worker, Worker& mine) {
    // Pairs with (3): what is in the bags was unlinked before the epoch that is read below ends.
    // Who comes to it all the same has announced itself by then, and no later epoch than that one.
    full_fence();
    // (2) seq_cst: pairs with (4), so that what others read in the epochs that are over was read
    // before it is freed. Comes after the fences of all who had seen only the epoch before, and so
    // does what this worker announces or looks at from now on
    mine.epoch = epoch_.load(std::memory_order_seq_cst);
    mine.seen = 0;
    free(worker, mine.limbo.change());
  }

  // Moves the epoch on if everybody inside has announced it.
  void look(Worker& mine) {
    for (; mine.seen < workers_.size(); ++mine.seen) {
      // (5) seq_cst: pairs with (1); and with (3), which it must not miss when a fence came between
      const std::uint64_t announced = workers_[mine.seen].announced.load(std::memory_order_seq_cst);
      if (announced != outside && announced != mine.epoch) return;
    }
    std::uint64_t expected = mine.epoch;
    // (4) release: pairs with (2). relaxed on failure: somebody else has done it
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
