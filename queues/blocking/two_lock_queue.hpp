/// LOCK: a linked list with one lock for each end (the thesis' listing 7.1; Michael and Scott 1996,
/// "Simple, Fast, and Practical Non-Blocking and Blocking Concurrent Queue Algorithms", figure 2).
///
/// When to use: producers and consumers in similar numbers and cores to spare, since a push waits
/// for pushes only and a pop for pops only. When not: threads may be stopped inside the lock (more
/// threads than cores, priorities), or all contention is on one end anyway.
///
/// Ordering: FIFO by happens-before. The two ends share no lock, so `pop` may miss a push that has
/// returned where nothing else orders the two calls. Progress: blocking. Memory: one node per task,
/// deleted at once. Unbounded.
///
/// How it works: a sentinel node stands before the first task. Pushes link a node behind the last
/// one, pops make the first node the new sentinel and delete the old one.
///
/// What differs from the listing, and why:
/// - `next` is atomic. When the queue is empty both ends meet at the sentinel: a push writes its
///   `next` under one lock while a pop reads it under the other, which is a data race.
/// - `pop` returns the value of the new sentinel. The listing returns that of the old one, which
///   hands out the first sentinel's undefined value and is one task late ever after.
/// - Nodes are allocated outside the lock, as the listing already does for deleting them.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string_view>
#include <utility>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The algorithm. `Lock::Guard` holds a lock as long as it lives.
template <class T, class Lock>
class TwoLockList {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  TwoLockList(unsigned /*workers*/, std::size_t /*capacity*/) {}
  TwoLockList(const TwoLockList&) = delete;
  TwoLockList& operator=(const TwoLockList&) = delete;

  ~TwoLockList() {
    while (head_ != nullptr) {
      // relaxed: destruction is single-threaded.
      Node* next = head_->next.load(std::memory_order_relaxed);
      delete head_;
      head_ = next;
    }
  }

  /// Adds `task` at the back. Blocking: waits for other pushes. Always true.
  bool push(unsigned /*worker*/, T task) {
    Node* node = new Node{std::move(task)};
    const typename Lock::Guard guard(add_lock_);
    // (1) release: pairs with the acquire load (2) in pop(), so that the task is read as written
    tail_->next.store(node, std::memory_order_release);
    tail_ = node;
    return true;
  }

  /// Takes the oldest task; false if it sees none. Blocking: waits for other pops.
  bool pop(unsigned /*worker*/, T& task) {
    Node* old = nullptr;
    {
      const typename Lock::Guard guard(get_lock_);
      // (2) acquire: pairs with the release store (1) in push()
      Node* first = head_->next.load(std::memory_order_acquire);
      if (first == nullptr) return false;
      task = std::move(first->task);
      old = head_;
      head_ = first;
    }
    // No push can hold it: `tail_` leaves a node in the same critical section that sets its `next`.
    delete old;
    return true;
  }

 private:
  struct Node {
    T task{};
    std::atomic<Node*> next{nullptr};
  };

  alignas(cache_line_pair) Lock get_lock_;
  Node* head_ = new Node;
  alignas(cache_line_pair) Lock add_lock_;
  Node* tail_ = head_;
};

/// A mutex with the face of our own locks.
class Mutex : public std::mutex {
 public:
  using Guard = std::lock_guard<std::mutex>;
};

template <class T>
class TwoLockQueue : public TwoLockList<T, Mutex> {
 public:
  static constexpr std::string_view summary =
      "LOCK (thesis 7.1): linked list, one mutex for each end";
  using TwoLockList<T, Mutex>::TwoLockList;
};

}  // namespace irt
