/// Healthy: Peterson's lock over a plain list, which stands on the single order of seq_cst
/// operations, after `before` further seq_cst loads in every call. A checker that drops that order
/// where it gets long sees a race that C++ forbids.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, int before>
class ManyScCase {
 public:
  static constexpr std::string_view summary = "Peterson's lock after many seq_cst loads";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  ManyScCase(unsigned workers, std::size_t /*capacity*/) : two_(workers <= 2) {}
  ~ManyScCase() {
    while (head_ != nullptr) {
      Node* next = head_->next;
      delete head_;
      head_ = next;
    }
  }

  bool push(unsigned worker, T task) {
    Node* node = new Node{task, nullptr};
    lock(worker);
    tail_->next = node;
    tail_ = node;
    unlock(worker);
    return true;
  }

  bool pop(unsigned worker, T& task) {
    lock(worker);
    Node* old = head_;
    Node* next = old->next;
    if (next != nullptr) {
      task = next->task;
      head_ = next;
    }
    unlock(worker);
    if (next == nullptr) return false;
    delete old;
    return true;
  }

 private:
  struct Node {
    T task;
    Node* next;
  };
  // Peterson is for two; with more workers a plain flag of the compiler's does.
  void lock(unsigned worker) {
    for (int i = 0; i < before; ++i) (void)unused_.load();
    if (!two_) {
      while (busy_.exchange(true)) {
      }
      return;
    }
    wants_[worker].store(true);
    turn_.store(1 - worker);
    while (wants_[1 - worker].load() && turn_.load() == 1 - worker) {
    }
  }
  void unlock(unsigned worker) {
    if (two_) {
      wants_[worker].store(false);
    } else {
      busy_.store(false);
    }
  }

  const bool two_;
  std::atomic<int> unused_{0};
  std::atomic<bool> busy_{false};
  std::atomic<bool> wants_[2]{};
  std::atomic<unsigned> turn_{0};
  Node* head_ = new Node{T{}, nullptr};
  Node* tail_ = head_;
};

template <class T>
class ManySc : public ManyScCase<T, 200> {
  using ManyScCase<T, 200>::ManyScCase;
};
template <class T>
class FewSc : public ManyScCase<T, 0> {
  using ManyScCase<T, 0>::ManyScCase;
};

}  // namespace irt
