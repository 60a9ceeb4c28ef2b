/// Hyaline-1 (Nikolaev and Ravindran 2021, "Snapshot-Free, Transparent, and Robust Memory
/// Reclamation for Lock-Free Data Structures", PLDI): retired nodes are handed to those who may be
/// reading them, and the last one frees them.
///
/// When to use: operations read many nodes; memory should come back as soon as nobody can read it,
/// and who reads should do its share of freeing. When not: a thread may stand still inside an
/// operation, for all that is retired from then on is handed to it, too. (The paper's Hyaline-1S
/// bounds that by eras.)
///
/// Progress: `guard`, and its end apart from what it frees, are wait-free but for handing out a
/// batch, which is lock-free; all else is wait-free. Memory: nodes wait until `batch` of them, and
/// at least one for each other worker, are retired, and then for those who were inside at that
/// moment. A worker outside holds nobody back.
///
/// How it works: each worker has a slot, which is empty (null) while it is outside and otherwise
/// the head of a list. A full batch is put into the lists of all who are inside, each time by the
/// link of another of its nodes. Who ends an operation takes its list away and counts itself out of
/// each batch there; who handed the batch out adds how often it did, at last. At zero the batch is
/// freed. Who is found outside has to see the nodes unlinked: it shows itself and then looks, the
/// other unlinks and then looks at its slot, which is Dekker's pattern. Here the reader has a
/// seq_cst store and seq_cst loads, the other side one fence for each batch, so that the structure
/// itself may unlink with any order.
///
/// What differs from the paper, and why:
/// - A batch is handed out when the operation is over, so that one's own slot needs no node of it.
/// - The count is in a batch's first node beside its link, where the paper sets a node of each
/// batch
///   aside for it. So a batch may be as small as there are other workers; a node is larger by a
///   word.
#pragma once

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/full_fence.hpp"
#include "queues/reclamation/reclaimer.hpp"

namespace irt {

template <class Node, template <class> class Nodes = HeapNodes>
class Hyaline {
  struct Batched {
    Batched* next = nullptr;                 // in the list of a slot
    Batched* sibling = nullptr;              // in the batch
    Batched* first = nullptr;                // of the batch
    std::atomic<std::ptrdiff_t> holders{0};  // of the batch; in its first node
  };

  struct Linked : Node, Batched {
    template <class... Arguments>
    explicit Linked(Arguments&&... arguments) : Node{std::forward<Arguments>(arguments)...} {}
  };

 public:
  static constexpr Offers offers{.nodes = any_number, .follows_retired = true};

  /// `batch` retired nodes are handed out at once, or more, so that there is one for each slot.
  Hyaline(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>({batch, workers - 1, 1})),
        nodes_(workers, batch_),
        workers_(workers) {}
  Hyaline(const Hyaline&) = delete;
  Hyaline& operator=(const Hyaline&) = delete;

  ~Hyaline() {
    for (Worker& worker : workers_) free(0, worker.retired);
  }

  class Guard : public ProtectsAll<Node> {
   public:
    Guard(Hyaline& all, unsigned worker) : all_(all), worker_(worker) {
      // (1) seq_cst: together with protect() pairs with the fence in hand_out(), so that either (3)
      // finds the slot in use or protect() finds `source` changed
      all_.workers_[worker_].slot.store(&all_.end_, std::memory_order_seq_cst);
    }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    ~Guard() { all_.end_operation(worker_); }

    /// The node that `source` holds. Wait-free.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      // seq_cst: see (1)
      return source.load(std::memory_order_seq_cst);
    }

    /// Frees `node` when all who are inside at the end of this operation, or a later one, have
    /// left. Wait-free.
    void retire(Node* node) const { all_.retire(worker_, static_cast<Linked*>(node)); }

   private:
    Hyaline& all_;
    unsigned worker_;
  };

  [[nodiscard]] Guard guard(unsigned worker) { return {*this, worker}; }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    return nodes_.make(worker, std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, static_cast<Linked*>(node)); }

 private:
  struct alignas(cache_line_pair) Worker {
    std::atomic<Batched*> slot{nullptr};
    // The worker's own:
    Batched* retired = nullptr;  // the batch that is not full yet
    std::size_t count = 0;       // of its nodes
  };

  void retire(unsigned worker, Batched* node) {
    Worker& mine = workers_[worker];
    node->sibling = mine.retired;
    mine.retired = node;
    ++mine.count;
  }

  void end_operation(unsigned worker) {
    Worker& mine = workers_[worker];
    // (2) acq_rel: pairs with (4), to take the list as it was made; and with (3) and (6), so that
    // what was read inside was read before it is freed by who finds the slot empty
    Batched* link = mine.slot.exchange(nullptr, std::memory_order_acq_rel);
    while (link != &end_) {
      Batched* next = link->next;  // before the batch may go
      count(worker, link->first, -1);
      link = next;
    }
    if (mine.count < batch_) return;
    mine.count = 0;
    hand_out(worker, std::exchange(mine.retired, nullptr));
  }

  void hand_out(unsigned worker, Batched* batch) {
    assert(batch != nullptr);
    for (Batched* node = batch; node != nullptr; node = node->sibling) node->first = batch;
    // Pairs with (1): what this thread unlinked, or saw unlinked, comes before the loads below.
    full_fence();
    std::ptrdiff_t holders = 0;
    Batched* link = batch;
    for (Worker& other : workers_) {
      if (&other == &workers_[worker]) continue;
      assert(link != nullptr);  // there is one for each other worker
      // (3) acquire: pairs with (2), where the slot is empty; comes after the fence, for (1)
      link->next = other.slot.load(std::memory_order_acquire);
      while (link->next != nullptr &&
             // (4) release: pairs with (2), so that who takes the list finds the batch whole
             // (6) acquire: on failure; pairs with (2), where the slot is empty now
             !other.slot.compare_exchange_weak(link->next, link, std::memory_order_release,
                                               std::memory_order_acquire)) {
      }
      if (link->next == nullptr) continue;
      ++holders;
      link = link->sibling;
    }
    count(worker, batch, holders);
  }

  // So many more hold the batch, or fewer; it goes with the last one. Below zero while who hands it
  // out has not said yet how often it did.
  void count(unsigned worker, Batched* batch, std::ptrdiff_t more) {
    // (5) acq_rel: the counts of hyaline.hpp pair with each other, so that all have read what the
    // last one frees
    if (batch->holders.fetch_add(more, std::memory_order_acq_rel) + more == 0) free(worker, batch);
  }

  void free(unsigned worker, Batched* batch) {
    while (batch != nullptr) {
      Batched* sibling = batch->sibling;
      nodes_.free(worker, static_cast<Linked*>(batch));
      batch = sibling;
    }
  }

  std::size_t batch_;
  Nodes<Linked> nodes_;
  std::vector<Worker> workers_;
  Batched end_;  // of each list
};

}  // namespace irt
