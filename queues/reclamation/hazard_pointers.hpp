/// Hazard pointers (Michael 2004, "Hazard Pointers: Safe Memory Reclamation for Lock-Free
/// Objects"): a node that was taken out of a structure is freed only when no thread says that it
/// reads it.
///
/// When to use: the structure reads a few nodes at a time, and a stalled thread must not hold back
/// more than those. When not: operations walk long chains; every node costs a full barrier here.
///
/// Progress: `try_protect` is wait-free, `protect` lock-free; `retire` takes a bounded number of
/// steps apart from the allocator. Memory: each worker holds back at most `places * workers +
/// batch` nodes; all are freed at destruction.
///
/// How it works: a reader writes the node's address into a place of its own and then looks whether
/// the node can still be reached. Who unlinks a node keeps it in a private list and, once `batch`
/// new ones are there, reads all places and frees what none of them names. Store then load on one
/// side, unlink then load on the other: this is Dekker's pattern, and needs sequential consistency
/// on both sides. Here the reader has a seq_cst store and a seq_cst load, the other side one fence
/// for each scan, so that the structure itself may unlink with any order.
///
/// Not done: a place is not cleared when a guard ends but overwritten by a later one, so an idle
/// worker holds back up to `places` nodes. What a guard has protected is safe until then, beyond
/// the guard's own end: no other reclaimer here promises that.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/full_fence.hpp"
#include "queues/reclamation/reclaimer.hpp"

namespace irt {

/// `places` nodes of each worker can be protected at once.
template <class Node, std::size_t places, template <class> class Nodes = HeapNodes>
class HazardPointers {
 public:
  static constexpr Offers offers{.nodes = places};

  /// For `workers` workers (see queues/work_queue.hpp for what a worker is). A scan follows every
  /// `batch` retired nodes, at least 1: more nodes held back, less work for each.
  HazardPointers(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)),
        nodes_(workers, batch_),
        hazards_(workers),
        retired_(workers) {
    const std::size_t all = places * workers;
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
      for (Node* node : mine.nodes) nodes_.free(0, node);
  }

  class Guard {
   public:
    Guard(HazardPointers& all, unsigned worker) : all_(all), worker_(worker) {}

    /// The node that `source` holds. Lock-free: repeats only if `source` changed meanwhile.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      for (;;) {
        // relaxed: a guess that try_protect() confirms
        Node* node = source.load(std::memory_order_relaxed);
        if (try_protect<place>(node, source, node)) return node;
      }
    }

    /// Protects `node`, and says whether `source` still holds `expected`. Wait-free.
    template <std::size_t place>
    bool try_protect(Node* node, const std::atomic<Node*>& source, const Node* expected) const {
      static_assert(place < places, "there are fewer hazard pointers");
      // (1) seq_cst: together with the load below pairs with (3) in scan(), so that either the scan
      // finds the node here or the load finds `source` changed. As a release it also ends the use
      // of the place's former node, and pairs with (2)
      all_.hazards_[worker_].place[place].store(node, std::memory_order_seq_cst);
      return source.load(std::memory_order_seq_cst) == expected;
    }

    /// Frees `node` as soon as nobody protects it: the fence that begins a scan acquires what made
    /// it unreachable.
    void retire(Node* node) const { all_.retire(worker_, node); }

   private:
    HazardPointers& all_;
    unsigned worker_;
  };

  [[nodiscard]] Guard guard(unsigned worker) { return {*this, worker}; }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    return nodes_.make(worker, std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, node); }

 private:
  struct alignas(cache_line_pair) Hazards {
    std::array<std::atomic<Node*>, places> place{};
  };

  struct alignas(cache_line_pair) Retired {
    std::vector<Node*> nodes;
    std::vector<Node*> hazards;  // of the scan in hand; here to keep its memory
    std::size_t scan_at = 0;
  };

  void retire(unsigned worker, Node* node) {
    Retired& mine = retired_[worker];
    mine.nodes.push_back(node);
    if (mine.nodes.size() >= mine.scan_at) scan(worker, mine);
  }

  void scan(unsigned worker, Retired& mine) {
    // (3) seq_cst: pairs with (1); what this thread unlinked, or saw unlinked, comes before the
    // loads below
    full_fence();
    mine.hazards.clear();
    for (const Hazards& hazards : hazards_)
      for (const std::atomic<Node*>& place : hazards.place)
        // (2) acquire: pairs with (1) in try_protect(), so that a reader's last look at a node
        // happens before the node is freed
        mine.hazards.push_back(place.load(std::memory_order_acquire));
    std::sort(mine.hazards.begin(), mine.hazards.end());
    const auto kept =
        std::partition(mine.nodes.begin(), mine.nodes.end(), [&mine](const Node* node) {
          return std::binary_search(mine.hazards.begin(), mine.hazards.end(), node);
        });
    for (auto node = kept; node != mine.nodes.end(); ++node) nodes_.free(worker, *node);
    mine.nodes.erase(kept, mine.nodes.end());
    mine.scan_at = mine.nodes.size() + batch_;
  }

  std::size_t batch_;
  Nodes<Node> nodes_;
  std::vector<Hazards> hazards_;
  std::vector<Retired> retired_;
};

}  // namespace irt
