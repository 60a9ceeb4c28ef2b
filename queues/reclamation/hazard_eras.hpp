/// Hazard eras (Ramalhete and Correia 2017, "Brief Announcement: Hazard Eras - Non-Blocking Memory
/// Reclamation", SPAA): hazard pointers that name a time instead of a node.
///
/// When to use: as hazard pointers, where the barrier for each node is too dear: here a reader pays
/// it only when the era has changed since it last looked. When not: a structure may hold very many
/// nodes, for a stalled thread holds back all that were inside with it.
///
/// Progress: `try_protect` is wait-free, `protect` lock-free; `retire` takes a bounded number of
/// steps apart from the allocator. Memory: a place holds back the nodes that were made before the
/// era it names had ended and retired after that era had begun, so at most as many as have been
/// inside at once, and `batch` of each worker. As many again wait to be looked at. No thread can
/// make that grow for ever by standing still.
///
/// How it works: a clock counts eras. A node knows the era in which it was made and, once it was
/// retired, one in which it was out of reach. A reader writes the era into a place of its own and
/// then takes a node: if the era has not changed meanwhile, the node was made before. Who has
/// `batch` retired nodes dates them by the era, ends it, and frees those that no place's era falls
/// in. Store then load on one side, unlink then load on the other, as in hazard_pointers.hpp.
///
/// What differs from the paper, and why:
/// - The era in which nodes are retired is read once for a batch, after its fence. It may be later
///   than the paper's, which is safe, and the structure may unlink with any order.
/// - An era ends with each batch instead of each retired node, and only as many batches as are held
///   back already lead to a scan.
/// - A place is not cleared when a guard ends, so that the next guard finds the era there.
/// - A node that was read from another node is protected by asking whether the first is still
///   inside. The paper's `get_protected` asks whether the link is as it was, which it is for ever
///   once the first node has been retired.
#pragma once

#include <algorithm>
#include <array>
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

/// `places` nodes of each worker can be protected at once.
template <class Node, std::size_t places, template <class> class Nodes = HeapNodes>
class HazardEras {
  using Era = std::uint64_t;

  struct Aged : Node {
    template <class... Arguments>
    explicit Aged(Era now, Arguments&&... arguments)
        : Node{std::forward<Arguments>(arguments)...}, born(now) {}

    const Era born;
    Era gone = 0;  // once it is dated
    Aged* below = nullptr;
  };

 public:
  static constexpr Offers offers{.nodes = places};

  /// A worker ends an era with every `batch` retired nodes.
  HazardEras(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)),
        nodes_(workers, batch_),
        hazards_(workers),
        retired_(workers) {
    for (Retired& mine : retired_) {
      mine.eras.reserve(places * workers);
      mine.scan_at = batch_;
    }
  }
  HazardEras(const HazardEras&) = delete;
  HazardEras& operator=(const HazardEras&) = delete;

  ~HazardEras() {
    for (Retired& mine : retired_)
      for (Bag<Aged>* bag : {&mine.fresh, &mine.dated})
        while (Aged* node = bag->take()) nodes_.free(0, node);
  }

  class Guard {
   public:
    Guard(HazardEras& all, unsigned worker) : all_(all), worker_(worker) {}

    /// The node that `source` holds. Lock-free: repeats only if a new era has begun meanwhile.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      for (;;) {
        // seq_cst: as in try_protect()
        Node* node = source.load(std::memory_order_seq_cst);
        if (!all_.template write_era<place>(worker_)) return node;
      }
    }

    /// Protects `node`, and says whether `source` still holds `expected`. Wait-free.
    template <std::size_t place>
    bool try_protect(Node* /*node*/, const std::atomic<Node*>& source, const Node* expected) const {
      all_.template write_era<place>(worker_);
      // seq_cst: together with (1) pairs with the fence in end_era(), so that either the scan
      // finds the era, or this finds `source` changed
      return source.load(std::memory_order_seq_cst) == expected;
    }

    /// Frees `node` as soon as no place holds an era in which it was inside.
    void retire(Node* node) const { all_.retire(worker_, static_cast<Aged*>(node)); }

   private:
    HazardEras& all_;
    unsigned worker_;
  };

  [[nodiscard]] Guard guard(unsigned worker) { return {*this, worker}; }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    // relaxed: who reads the node has seen this era begin, and none of its own is earlier
    return nodes_.make(worker, era_.load(std::memory_order_relaxed),
                       std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, static_cast<Aged*>(node)); }

 private:
  struct alignas(cache_line_pair) Hazards {
    std::array<std::atomic<Era>, places> place{};
  };

  struct alignas(cache_line_pair) Retired {
    Bag<Aged> fresh;  // since this worker last ended an era
    Bag<Aged> dated;
    std::vector<Era> eras;  // of the scan in hand; here to keep its memory
    std::size_t scan_at = 0;
  };

  // Writes down the era; whether it is another one than stands there already.
  template <std::size_t place>
  bool write_era(unsigned worker) {
    static_assert(place < places, "there are fewer hazard eras");
    std::atomic<Era>& mine = hazards_[worker].place[place];
    // seq_cst: comes before the fence of whoever dates nodes by an earlier era, in the order of
    // all; (1) would then be seen there
    const Era now = era_.load(std::memory_order_seq_cst);
    // relaxed: only this worker writes there
    if (mine.load(std::memory_order_relaxed) == now) return false;
    // (1) seq_cst: pairs with the fence in end_era(); as a release also with (2)
    mine.store(now, std::memory_order_seq_cst);
    return true;
  }

  void retire(unsigned worker, Aged* node) {
    Retired& mine = retired_[worker];
    mine.fresh.add(node);
    if (mine.fresh.size() < batch_) return;
    end_era(mine);
    if (mine.dated.size() >= mine.scan_at) scan(worker, mine);
  }

  // However much is held back: or else more and more nodes would be of one era.
  void end_era(Retired& mine) {
    // Pairs with (1): what this thread unlinked, or saw unlinked, comes before the loads below, and
    // before the places are read.
    full_fence();
    // relaxed, twice: the fence comes between the unlinking and the era, and a reader that came to
    // a node before that has read no later one
    const Era now = era_.load(std::memory_order_relaxed);
    Era expected = now;
    era_.compare_exchange_strong(expected, now + 1, std::memory_order_relaxed);
    while (Aged* node = mine.fresh.take()) {
      node->gone = now;
      mine.dated.add(node);
    }
  }

  void scan(unsigned worker, Retired& mine) {
    mine.eras.clear();
    for (const Hazards& hazards : hazards_)
      for (const std::atomic<Era>& place : hazards.place)
        // (2) acquire: pairs with (1), so that a reader's last look at a node happens before the
        // node is freed
        mine.eras.push_back(place.load(std::memory_order_acquire));
    std::sort(mine.eras.begin(), mine.eras.end());
    Bag<Aged> kept;
    while (Aged* node = mine.dated.take()) {
      const auto era = std::lower_bound(mine.eras.begin(), mine.eras.end(), node->born);
      if (era != mine.eras.end() && *era <= node->gone)
        kept.add(node);
      else
        nodes_.free(worker, node);
    }
    mine.dated = kept;
    // Once there are as many again: the work for each stays the same, however many are held back.
    mine.scan_at = 2 * kept.size() + batch_;
  }

  std::size_t batch_;
  Nodes<Aged> nodes_;
  std::vector<Hazards> hazards_;
  std::vector<Retired> retired_;
  alignas(cache_line_pair) std::atomic<Era> era_{1};
};

}  // namespace irt
