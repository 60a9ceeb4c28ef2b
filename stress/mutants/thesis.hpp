/// The thesis' two listings as printed, in C++. Where the listing says CAS or leaves a shared
/// pointer plain beside it, the pointer is a std::atomic with sequential consistency: the most that
/// a reader of the listing may assume. Nothing else is added.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt::stress {

/// Listing 7.1 (LOCK). `addRays` writes `tail->next` under one lock while `getRays` reads
/// `head->next` under the other, and on an empty queue they are the same field. And line 17 returns
/// the value of the sentinel that leaves, not of the node that becomes the sentinel: the first
/// answer is a value nobody added, and the last element never comes out.
template <class T>
class ThesisLock {
 public:
  static constexpr std::string_view summary = "listing 7.1 as printed";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  ThesisLock(unsigned /*workers*/, std::size_t /*capacity*/) : head_(new Node), tail_(head_) {}
  ThesisLock(const ThesisLock&) = delete;
  ThesisLock& operator=(const ThesisLock&) = delete;
  ~ThesisLock() {
    while (head_ != nullptr) {
      Node* next = head_->next;
      delete head_;
      head_ = next;
    }
  }

  bool push(unsigned /*worker*/, T task) {
    add_lock_.lock();
    Node* node = new Node{task, nullptr};
    tail_->next = node;
    tail_ = node;
    add_lock_.unlock();
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    get_lock_.lock();
    if (head_->next == nullptr) {
      get_lock_.unlock();
      return false;
    }
    Node* actual = head_;
    head_ = head_->next;
    task = actual->value;
    get_lock_.unlock();
    delete actual;
    return true;
  }

 private:
  struct Node {
    T value{};
    Node* next = nullptr;
  };
  std::mutex add_lock_;
  std::mutex get_lock_;
  Node* head_;
  Node* tail_;
};

/// Listing 7.3 (LFREE). The old sentinel is deleted while others may still read its `next`.
template <class T>
class ThesisLfree {
 public:
  static constexpr std::string_view summary = "listing 7.3 as printed";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free};

  ThesisLfree(unsigned /*workers*/, std::size_t /*capacity*/) { head_ = tail_ = new Node; }
  ThesisLfree(const ThesisLfree&) = delete;
  ThesisLfree& operator=(const ThesisLfree&) = delete;
  ~ThesisLfree() {
    for (Node* node = head_; node != nullptr;) {
      Node* next = node->next;
      delete node;
      node = next;
    }
  }

  bool push(unsigned /*worker*/, T task) {
    Node* node = new Node;
    node->value = task;
    while (true) {
      Node* last = tail_;
      Node* next = last->next;
      if (last == tail_) {
        if (next == nullptr) {
          if (last->next.compare_exchange_strong(next, node)) {
            tail_.compare_exchange_strong(last, node);
            return true;
          }
        } else {
          tail_.compare_exchange_strong(last, next);
        }
      }
    }
  }

  bool pop(unsigned /*worker*/, T& task) {
    while (true) {
      Node* first = head_;
      Node* last = tail_;
      Node* next = first->next;
      if (first == head_) {
        if (first == last) {
          if (next == nullptr) return false;
          tail_.compare_exchange_strong(last, next);
        } else {
          task = next->value;
          if (head_.compare_exchange_strong(first, next)) {
            delete first;
            return true;
          }
        }
      }
    }
  }

 private:
  struct Node {
    T value{};
    std::atomic<Node*> next{nullptr};
  };
  std::atomic<Node*> head_;
  std::atomic<Node*> tail_;
};

}  // namespace irt::stress
