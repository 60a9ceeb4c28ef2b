/// LFREE: Michael and Scott's lock-free queue (the thesis' listing 7.3; Michael and Scott 1996,
/// "Simple, Fast, and Practical Non-Blocking and Blocking Concurrent Queue Algorithms", figure 1),
/// with hazard pointers.
///
/// When to use: a stopped thread must not stop the others. When not: many cores push and pop at
/// once, for then most compare-and-swaps fail and are repeated.
///
/// Ordering: FIFO by happens-before: `pop` may miss a push that has returned where nothing else
/// orders the two calls. (With seq_cst at (2) and (3) it would be FIFO in real time.) Progress:
/// lock-free, apart from the allocator. Memory: one node per task, from the allocator; nodes that
/// have left wait for hazard pointers, see there for the bound. Unbounded. The same list with other
/// reclaimers stands in reclaimed_michael_scott_queues.hpp, and one that keeps its nodes for reuse
/// in counted_michael_scott_queue.hpp.
///
/// How it works: a linked list behind a sentinel. A push links its node behind the last one and
/// then moves `tail_`, or lets any other thread do it. A pop moves `head_` one node on; the node it
/// arrives at is the new sentinel and has the task.
///
/// What differs from the listing, and why:
/// - Nodes are retired, not deleted. The listing deletes the old sentinel although other threads
///   may be about to read its `next`: use after free. And once its memory is a node again, a
///   delayed compare-and-swap takes it for the old one (ABA) and cuts the list.
/// - Each pointer is validated by the reclaimer, if need be, where the listing re-reads `head` or
///   `tail`.
/// - *Empty* needs no look at `tail_`: while a sentinel has no `next`, `head_` cannot have left it.
/// - All shared fields are atomic, with the weakest orders that do.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <string_view>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/reclamation/reclaimer.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The algorithm. `Reclaimer` protects nodes and frees them; queues/reclamation/reclaimer.hpp says
/// how.
template <class T, template <class Node> class Reclaimer>
class MichaelScottList {
  struct Node {
    T task{};
    std::atomic<Node*> next{nullptr};
  };

  /// The sentinel and the node behind it, which `head_` says is still inside.
  static constexpr Needs needs{.nodes = 2};
  static_assert(suits<Reclaimer<Node>::offers, needs>());

 public:
  /// Nodes are reclaimed in batches no larger than `capacity`: who expects few tasks gets few
  /// nodes held back.
  MichaelScottList(unsigned workers, std::size_t capacity)
      : nodes_(workers, std::min<std::size_t>(capacity, std::max(64U, 4 * workers))),
        first_(nodes_.make(0)),
        head_(first_),
        tail_(first_) {}
  MichaelScottList(const MichaelScottList&) = delete;
  MichaelScottList& operator=(const MichaelScottList&) = delete;

  ~MichaelScottList() {
    // relaxed: destruction is single-threaded
    Node* left = Reclaimer<Node>::offers.frees ? head_.load(std::memory_order_relaxed) : first_;
    discard(0, left);
  }

  /// Adds `task` at the back. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    Node* node = nodes_.make(worker, task);
    link(worker, node, node);
    return true;
  }

  /// Adds all of `tasks`, one behind the other, by one compare-and-swap. Lock-free.
  std::size_t push_bulk(unsigned worker, std::span<const T> tasks) {
    if (tasks.empty()) return 0;
    Chain chain{*this, worker};
    for (const T& task : tasks) chain.append(nodes_.make(worker, task));
    link(worker, chain.first, chain.last);
    chain.first = nullptr;
    return tasks.size();
  }

  /// Takes the oldest task; false if it sees none. Lock-free.
  bool pop(unsigned worker, T& task) {
    if (take(worker, task)) return true;
    // Who finds nothing may be about to sleep.
    irt::leave(nodes_, worker);
    return false;
  }

  /// As so many pops. Lock-free.
  std::size_t pop_bulk(unsigned worker, std::span<T> tasks) {
    std::size_t count = 0;
    while (count < tasks.size() && pop(worker, tasks[count])) ++count;
    return count;
  }

  /// Where the reclaimer asks for it.
  void leave(unsigned worker) requires HasLeave<Reclaimer<Node>> { nodes_.leave(worker); }

 private:
  /// Nodes that nobody else sees yet.
  struct Chain {
    MichaelScottList& list;
    unsigned worker;
    Node* first = nullptr;
    Node* last = nullptr;

    ~Chain() { list.discard(worker, first); }
    void append(Node* node) {
      if (first == nullptr) {
        first = node;
      } else {
        last->next.store(node, std::memory_order_relaxed);  // relaxed: (2) publishes all of them
      }
      last = node;
    }
  };

  // Gives back the nodes from `node` on, which nobody else can see.
  void discard(unsigned worker, Node* node) {
    while (node != nullptr) {
      // relaxed: nobody else writes there
      Node* next = node->next.load(std::memory_order_relaxed);
      nodes_.discard(worker, node);
      node = next;
    }
  }

  bool take(unsigned worker, T& task) {
    const auto guard = nodes_.guard(worker);
    for (;;) {
      Node* first = guard.template protect<0>(head_);
      // (3) acquire: pairs with (2), so that the task is read as written
      Node* next = first->next.load(std::memory_order_acquire);
      if (next == nullptr) return false;
      if (!guard.template try_protect<1>(next, head_, first)) continue;
      // `tail_` must have left `first` before `head_` does, or a push would find a freed node.
      // relaxed: coherence forbids to read it further back than who moved `head_` to `first` did,
      // and retire() asks for no more
      if (tail_.load(std::memory_order_relaxed) == first) {
        move_tail(first, next);
        continue;
      }
      const T taken = next->task;
      // (4) release: pairs with protect(), as reclaimer.hpp has it, so that whoever reads `next`
      // there finds the node whole and `tail_` no further back than it is seen here. relaxed on
      // failure: nothing is read
      Node* expected = first;
      if (head_.compare_exchange_strong(expected, next, std::memory_order_release,
                                        std::memory_order_relaxed)) {
        task = taken;
        guard.retire(first);
        return true;
      }
    }
  }

  // Puts the nodes from `first` to `end` behind the last one.
  void link(unsigned worker, Node* first, Node* end) {
    const auto guard = nodes_.guard(worker);
    for (;;) {
      Node* last = guard.template protect<0>(tail_);
      // (1) acquire: pairs with (2), so that a node we move `tail_` to is whole for who reads it
      // there
      Node* next = last->next.load(std::memory_order_acquire);
      if (next != nullptr) {
        move_tail(last, next);
        continue;
      }
      // (2) release: pairs with (1) and (3). relaxed on failure: nothing was read but a change
      if (last->next.compare_exchange_strong(next, first, std::memory_order_release,
                                             std::memory_order_relaxed)) {
        move_tail(last, end);
        return;
      }
    }
  }

  void move_tail(Node* from, Node* to) {
    // (5) release: pairs with protect(), so that `to` is whole for who reads it from `tail_`; and
    // with what retire() asks for, see reclaimer.hpp. relaxed on failure: another thread has done
    // it
    tail_.compare_exchange_strong(from, to, std::memory_order_release, std::memory_order_relaxed);
  }

  Reclaimer<Node> nodes_;
  Node* const first_;  // from here on all nodes are linked, where none is freed
  alignas(cache_line_pair) std::atomic<Node*> head_;
  alignas(cache_line_pair) std::atomic<Node*> tail_;
};

template <class Node>
using TwoHazardPointers = HazardPointers<Node, 2>;

template <class T>
class MichaelScottQueue : public MichaelScottList<T, TwoHazardPointers> {
 public:
  static constexpr std::string_view summary =
      "LFREE (thesis 7.3): Michael and Scott's queue, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .elements = {.large = true}};
  using MichaelScottList<T, TwoHazardPointers>::MichaelScottList;
};

}  // namespace irt
