/// A list behind a sentinel that is right as long as it is empty when it is destroyed. With
/// elements inside its destructors use a node after they freed it (as ConcurrencyFreaks'
/// CRTurnQueue does, `ae40ca8`: the sentinel goes first), lose the nodes, or free the sentinel
/// twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <utility>

#include "queues/work_queue.hpp"

namespace irt {

enum class DroppedBy : std::uint8_t { right, uses_freed, leaks, frees_twice };

template <class T, DroppedBy how>
class DroppedListCase {
 public:
  static constexpr std::string_view summary = "a list under a lock, and what its destructor does";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before};

  DroppedListCase(unsigned /*workers*/, std::size_t /*capacity*/) {}
  DroppedListCase(const DroppedListCase&) = delete;
  DroppedListCase& operator=(const DroppedListCase&) = delete;

  ~DroppedListCase() {
    T task{};
    Node* const first = head_;
    switch (how) {
      case DroppedBy::right:
        while (head_ != nullptr) delete std::exchange(head_, head_->next);
        break;
      case DroppedBy::uses_freed:
        delete sentinel_;
        while (pop(0, task)) {
        }
        if (head_ != sentinel_) delete head_;
        break;
      case DroppedBy::leaks:
        delete head_;
        break;
      case DroppedBy::frees_twice:
        while (pop(0, task)) {
        }
        delete first;
        break;
    }
  }

  bool push(unsigned /*worker*/, T task) {
    Node* const node = new Node{task, nullptr};
    const std::scoped_lock lock(mutex_);
    tail_->next = node;
    tail_ = node;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::scoped_lock lock(mutex_);
    Node* const first = head_;
    if (first->next == nullptr) return false;
    head_ = first->next;
    task = head_->task;
    if (how != DroppedBy::uses_freed || first != sentinel_) delete first;
    return true;
  }

 private:
  struct Node {
    T task{};
    Node* next = nullptr;
  };

  std::mutex mutex_;
  Node* const sentinel_ = new Node;
  Node* head_ = sentinel_;
  Node* tail_ = sentinel_;
};

template <class T>
class DroppedListFixed : public DroppedListCase<T, DroppedBy::right> {
  using DroppedListCase<T, DroppedBy::right>::DroppedListCase;
};
template <class T>
class DroppedListUsesBug : public DroppedListCase<T, DroppedBy::uses_freed> {
  using DroppedListCase<T, DroppedBy::uses_freed>::DroppedListCase;
};
template <class T>
class DroppedListLeaksBug : public DroppedListCase<T, DroppedBy::leaks> {
  using DroppedListCase<T, DroppedBy::leaks>::DroppedListCase;
};
template <class T>
class DroppedListTwiceBug : public DroppedListCase<T, DroppedBy::frees_twice> {
  using DroppedListCase<T, DroppedBy::frees_twice>::DroppedListCase;
};

}  // namespace irt
