/// CC-Queue: the list of LOCK with a combiner at each end in place of a lock (Fatourou and
/// Kallimanis 2012, "Revisiting the Combining Synchronization Technique", PPoPP).
///
/// When to use: many cores push and pop at once, each on a core of its own: one core does what all
/// ask for at one end, so that the end stays in its cache. When not: more threads than cores. A
/// combiner that loses its core stops its end for everybody; see `cc_synch.hpp`.
///
/// Ordering: FIFO in real time. Progress: blocking. Memory: one node per task, from the allocator,
/// deleted at once; besides eight lines for each worker. Unbounded.
///
/// How it works: a sentinel node stands before the first task. A push allocates a node and has it
/// linked behind the last one; a pop has the sentinel unlinked and the first task put into it,
/// takes the task and deletes the node. So whoever combines neither allocates nor frees, and where
/// memory runs out it is the push it runs out for that throws, with nothing done.
///
/// What differs from the paper, and why: linking and looking for a link are sequentially
/// consistent. The two ends share nothing else, and with weaker orders a pop might miss a push that
/// had returned. The price is a full barrier for each push.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

#include "queues/blocking/cc_synch.hpp"
#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class CcQueue {
  static_assert(std::is_nothrow_move_assignable_v<T>,
                "whoever combines moves the elements of others, and must not throw for them");

 public:
  static constexpr std::string_view summary = "CC-Queue: linked list, a combiner for each end";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  CcQueue(unsigned workers, std::size_t /*capacity*/)
      : pops_(workers), pushes_(workers), head_(new Node), tail_(head_) {}
  CcQueue(const CcQueue&) = delete;
  CcQueue& operator=(const CcQueue&) = delete;

  ~CcQueue() {
    while (head_ != nullptr) {
      // relaxed: destruction is single-threaded
      Node* next = head_->next.load(std::memory_order_relaxed);
      delete head_;
      head_ = next;
    }
  }

  /// Adds `task` at the back. Blocking: waits for other pushes. Always true.
  bool push(unsigned worker, T task) {
    pushes_.run(worker, new Node{std::move(task)}, [this](Node* node) {
      // (1) seq_cst: pairs with (2), so that the task is read as written, and a pop that begins
      // later sees it
      tail_->next.store(node, std::memory_order_seq_cst);
      tail_ = node;
    });
    return true;
  }

  /// Takes the oldest task; false if there is none. Blocking: waits for other pops.
  bool pop(unsigned worker, T& task) {
    Node* node = pops_.run(worker, nullptr, [this](Node*& taken) {
      // (2) seq_cst: pairs with (1)
      Node* first = head_->next.load(std::memory_order_seq_cst);
      if (first == nullptr) return;
      // No push can hold the sentinel: `tail_` leaves a node when its `next` is set.
      taken = std::exchange(head_, first);
      taken->task = std::move(first->task);
    });
    if (node == nullptr) return false;
    task = std::move(node->task);
    delete node;
    return true;
  }

 private:
  struct Node {
    T task{};
    std::atomic<Node*> next{nullptr};
  };

  CcSynch<Node*> pops_;
  CcSynch<Node*> pushes_;
  alignas(cache_line_pair) Node* head_;
  alignas(cache_line_pair) Node* tail_;
};

}  // namespace irt
