/// Concurrency Kit's `ck_fifo` for many producers and consumers: Michael and Scott's algorithm with
/// counted pointers.
///
/// When to use: beside LFREE and Boost.Lockfree, to see what a 16-byte compare-and-swap makes of
/// the same algorithm. When not: the processor has none.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator. Memory: one
/// node per task; a node goes back to the worker that made it, and is deleted only at destruction,
/// because a late reader may still look at it. Unbounded.
///
/// How it works: each pointer stands beside a counter that every change raises, so that a node in
/// its second life is told from its first. The library leaves nodes to its user: here a pop puts
/// the node on a list of its maker's, and the maker takes the whole list at once when it needs
/// nodes.
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/comparators/concurrency_kit.h"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class CkFifoQueue {
 public:
  static constexpr std::string_view summary = "Concurrency Kit ck_fifo: Michael and Scott's, CAS2";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::free_list,
                                 .needs_cas2 = true};

  CkFifoQueue(unsigned workers, std::size_t /*capacity*/)
      : nodes_(workers), fifo_(irt_ck_fifo_new(take_node(0))) {
    if (fifo_ == nullptr) throw std::bad_alloc();
  }

  /// Adds `task`. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    irt_ck_fifo_push(fifo_.get(), take_node(worker), word_of(task));
    return true;
  }

  /// Takes the oldest task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) {
    std::uint64_t word = 0;
    irt_ck_entry* left = nullptr;
    if (!irt_ck_fifo_pop(fifo_.get(), &word, &left)) return false;
    task = element_of<T>(word);
    give_back(static_cast<Node*>(left));
    return true;
  }

 private:
  struct Node : irt_ck_entry {
    unsigned maker = 0;
    Node* next_free = nullptr;
  };

  struct alignas(cache_line_pair) Nodes {
    std::deque<Node> made;
    Node* free = nullptr;
    alignas(cache_line_pair) std::atomic<Node*> given_back{nullptr};
  };

  Node* take_node(unsigned worker) {
    Nodes& mine = nodes_[worker];
    // (1) acquire: pairs with (2), so that a node's last use happens before its next
    if (mine.free == nullptr)
      mine.free = mine.given_back.exchange(nullptr, std::memory_order_acquire);
    if (mine.free == nullptr) {
      Node& node = mine.made.emplace_back();
      node.maker = worker;
      return &node;
    }
    Node* node = mine.free;
    mine.free = node->next_free;
    return node;
  }

  void give_back(Node* node) {
    std::atomic<Node*>& list = nodes_[node->maker].given_back;
    // relaxed: only written back, never followed
    node->next_free = list.load(std::memory_order_relaxed);
    // (2) release: pairs with (1). relaxed on failure: as the load above
    while (!list.compare_exchange_weak(node->next_free, node, std::memory_order_release,
                                       std::memory_order_relaxed)) {
    }
  }

  struct Delete {
    void operator()(irt_ck_fifo* fifo) const { irt_ck_fifo_delete(fifo); }
  };

  std::vector<Nodes> nodes_;
  std::unique_ptr<irt_ck_fifo, Delete> fifo_;
};

}  // namespace irt
