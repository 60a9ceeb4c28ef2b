/// Nodes that each worker keeps for its next ones (magazines: Bonwick and Adams 2001, "Magazines
/// and Vmem: Extending the Slab Allocator to Many CPUs and Arbitrary Resources", USENIX), for a
/// reclaimer that is done with them.
///
/// When to use: the allocator is most of what an operation costs. When not: a tool should see nodes
/// that are freed too early. Here they stay in the process until they are nodes again; what watches
/// the allocator, AddressSanitizer or the checker's heap, finds nothing.
///
/// Progress: wait-free, apart from the allocator. Memory: beside the nodes in use, three times
/// `batch` of each worker, which go at destruction.
///
/// How it works: a worker has two magazines of up to `batch` spare nodes and takes from and gives
/// to the first. When that one is empty, or full, the other takes its place; so a worker that goes
/// to and fro at the edge does not leave its own. When both are full, one is put on a shelf that
/// all share; when both are empty, one is taken from there. So where some only push and others only
/// pop, nodes still come back. A shelf holds one full magazine and is filled by compare-and-swap
/// from empty, emptied by exchange: nobody reads what it does not own, so there is no ABA. When all
/// shelves are full, or empty, the allocator takes a magazine, or gives a node.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"

namespace irt {

template <class Node>
class NodeCache {
 public:
  /// A magazine has `batch` nodes, at least 1.
  NodeCache(unsigned workers, std::size_t batch)
      : batch_(std::max<std::size_t>(batch, 1)), caches_(workers), shelves_(workers) {}
  NodeCache(const NodeCache&) = delete;
  NodeCache& operator=(const NodeCache&) = delete;

  ~NodeCache() {
    for (Cache& mine : caches_) {
      give_back(mine.first.top);
      give_back(mine.second.top);
    }
    // relaxed: destruction is single-threaded
    for (Shelf& shelf : shelves_) give_back(shelf.load(std::memory_order_relaxed));
  }

  /// A new node, where an old one was if there is one. Wait-free, apart from the allocator.
  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    void* place = take(caches_[worker]);
    try {
      return ::new (place) Node{std::forward<Arguments>(arguments)...};
    } catch (...) {
      put(caches_[worker], place);
      throw;
    }
  }

  /// Wait-free, apart from the allocator.
  void free(unsigned worker, Node* node) {
    node->~Node();
    put(caches_[worker], node);
  }

 private:
  /// A place for a node.
  struct Spare {
    Spare* below;
  };
  static_assert(sizeof(Node) >= sizeof(Spare), "a node's place has no room for a link");
  static_assert(alignof(Node) >= alignof(Spare), "a node's place is not aligned for a link");

  struct Magazine {
    Spare* top = nullptr;
    std::size_t count = 0;
  };

  struct alignas(cache_line_pair) Cache {
    Magazine first;
    Magazine second;
  };

  using Shelf = std::atomic<Spare*>;

  void* take(Cache& mine) {
    if (mine.first.top == nullptr) std::swap(mine.first, mine.second);
    if (mine.first.top == nullptr) mine.first = from_shelf();
    if (mine.first.top == nullptr) return std::allocator<Node>{}.allocate(1);
    --mine.first.count;
    return std::exchange(mine.first.top, mine.first.top->below);
  }

  void put(Cache& mine, void* place) {
    if (mine.first.count == batch_) std::swap(mine.first, mine.second);
    if (mine.first.count == batch_) put_away(std::exchange(mine.first, {}).top);
    mine.first.top = ::new (place) Spare{mine.first.top};
    ++mine.first.count;
  }

  Magazine from_shelf() {
    for (Shelf& shelf : shelves_) {
      // relaxed: only whether it is worth the exchange
      if (shelf.load(std::memory_order_relaxed) == nullptr) continue;
      // (1) acquire: pairs with (2), so that the places are linked for who takes them, and nobody
      // uses them any more
      Spare* top = shelf.exchange(nullptr, std::memory_order_acquire);
      if (top != nullptr) return {top, batch_};
    }
    return {};
  }

  void put_away(Spare* top) {
    for (Shelf& shelf : shelves_) {
      Spare* expected = nullptr;
      // (2) release: pairs with (1). relaxed on failure: another shelf is tried
      if (shelf.compare_exchange_strong(expected, top, std::memory_order_release,
                                        std::memory_order_relaxed))
        return;
    }
    give_back(top);
  }

  static void give_back(Spare* top) {
    while (top != nullptr) {
      Spare* below = top->below;
      std::allocator<Node>{}.deallocate(reinterpret_cast<Node*>(top), 1);
      top = below;
    }
  }

  std::size_t batch_;
  std::vector<Cache> caches_;
  std::vector<Shelf> shelves_;  // close together: they are seldom written
};

}  // namespace irt
