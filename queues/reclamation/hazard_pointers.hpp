/// Hazard pointers (Michael 2004, "Hazard Pointers: Safe Memory Reclamation for Lock-Free
/// Objects"): a node that was taken out of a structure is freed only when no thread says that it
/// reads it.
///
/// When to use: the structure reads a few nodes at a time, and a stalled thread must not hold back
/// more than those. When not: operations walk long chains; every node costs a full barrier here.
///
/// Progress: `publish` is wait-free, `protect` lock-free; `retire` takes a bounded number of steps
/// apart from the allocator. Memory: each worker holds back at most `slots * workers + batch`
/// nodes; all are freed at destruction.
///
/// How it works: a reader writes the node's address into a slot of its own and then looks whether
/// the node can still be reached. Who unlinks a node keeps it in a private list and, once `batch`
/// new ones are there, reads all slots and frees what none of them names. Store then load on one
/// side, unlink then load on the other: this is Dekker's pattern, and needs sequential consistency
/// on both sides. Here the reader has a seq_cst store and a seq_cst load, the other side one fence
/// for each scan, so that the structure itself may unlink with any order.
///
/// Not done: a slot is not cleared after use but overwritten by the next operation, so an idle
/// worker holds back up to `slots` nodes.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "queues/cache_line.hpp"

namespace irt {

/// `slots` nodes per worker can be protected at once. `Free` gives a node back.
template <class Node, std::size_t slots, class Free = std::default_delete<Node>>
class HazardPointers {
 public:
  /// What is retired is freed.
  static constexpr bool frees = true;

  /// For `workers` workers (see queues/work_queue.hpp for what a worker is). A scan follows every
  /// `batch` retired nodes, at least 1: more nodes held back, less work for each.
  HazardPointers(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)), hazards_(workers), retired_(workers) {
    const std::size_t all = slots * workers;
    for (Retired& mine : retired_) {
      mine.nodes.reserve(all + batch_);
      mine.hazards.reserve(all);
      mine.scan_at = batch_;
    }
  }
  HazardPointers(const HazardPointers&) = delete;
  HazardPointers& operator=(const HazardPointers&) = delete;

  ~HazardPointers() {
    for (const Retired& mine : retired_)
      for (Node* node : mine.nodes) Free{}(node);
  }

  /// Protects `node` in `slot` of `worker` and says whether `source` still holds `expected`. If the
  /// structure never retires `node` before it has changed `source`, then `true` means that `node`
  /// is safe to read until the slot is used again. Wait-free.
  bool publish(unsigned worker, std::size_t slot, Node* node, const std::atomic<Node*>& source,
               const Node* expected) {
    // (1) seq_cst: together with the load below pairs with (3) in scan(), so that either the scan
    // finds the node here or the load finds `source` changed. As a release it also ends the use of
    // the slot's former node, and pairs with (2)
    hazards_[worker].slot[slot].store(node, std::memory_order_seq_cst);
    return source.load(std::memory_order_seq_cst) == expected;
  }

  /// Protects the node that `source` holds and returns it; at least as strong as an acquire load of
  /// `source`. Lock-free: repeats only if `source` changed meanwhile.
  Node* protect(unsigned worker, std::size_t slot, const std::atomic<Node*>& source) {
    for (;;) {
      // relaxed: a guess that publish() confirms
      Node* node = source.load(std::memory_order_relaxed);
      if (publish(worker, slot, node, source, node)) return node;
    }
  }

  /// Frees `node` as soon as nobody protects it. Whatever made `node` unreachable must be this
  /// thread's own doing, or a release whose effect it has read, be it relaxed: the fence that
  /// begins a scan acquires it.
  void retire(unsigned worker, Node* node) {
    Retired& mine = retired_[worker];
    mine.nodes.push_back(node);
    if (mine.nodes.size() >= mine.scan_at) scan(mine);
  }

 private:
  struct alignas(cache_line_pair) Hazards {
    std::array<std::atomic<Node*>, slots> slot{};
  };

  struct alignas(cache_line_pair) Retired {
    std::vector<Node*> nodes;
    std::vector<Node*> hazards;  // of the scan in hand; here to keep its memory
    std::size_t scan_at = 0;
  };

  void scan(Retired& mine) {
    // (3) seq_cst: pairs with (1); what this thread unlinked, or saw unlinked, comes before the
    // loads below
    fence();
    mine.hazards.clear();
    for (const Hazards& hazards : hazards_)
      for (const std::atomic<Node*>& slot : hazards.slot)
        // (2) acquire: pairs with (1) in publish(), so that a reader's last look at a node happens
        // before the node is freed
        mine.hazards.push_back(slot.load(std::memory_order_acquire));
    std::sort(mine.hazards.begin(), mine.hazards.end());
    const auto kept =
        std::partition(mine.nodes.begin(), mine.nodes.end(), [&mine](const Node* node) {
          return std::binary_search(mine.hazards.begin(), mine.hazards.end(), node);
        });
    for (auto node = kept; node != mine.nodes.end(); ++node) Free{}(*node);
    mine.nodes.erase(kept, mine.nodes.end());
    mine.scan_at = mine.nodes.size() + batch_;
  }

  // GCC warns that TSan does not model fences. It need not: the fence decides what a scan reads,
  // the happens-before edges come from the slots.
  static void fence() {
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wtsan"
#endif
    std::atomic_thread_fence(std::memory_order_seq_cst);
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
  }

  std::size_t batch_;
  std::vector<Hazards> hazards_;
  std::vector<Retired> retired_;
};

}  // namespace irt
