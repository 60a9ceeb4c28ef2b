/// Queues with a lock for each end: a list (M18) and a list of pages (M13).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string_view>
#include <type_traits>

#include "queues/work_queue.hpp"

namespace irt::stress {

/// `atomic_next` is the healthy twin. M18: with a plain `next`, the producer writes the sentinel's
/// under the tail lock while a consumer reads it under the head lock.
template <bool atomic_next>
struct TwoLock {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a list with a lock for each end";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) : head_(new Node), tail_(head_) {}
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    ~Queue() {
      while (head_ != nullptr) {
        Node* next = head_->next;
        delete head_;
        head_ = next;
      }
    }

    bool push(unsigned /*worker*/, T task) {
      Node* node = new Node;
      node->value = task;
      const std::lock_guard lock(tail_lock_);
      tail_->next = node;
      tail_ = node;
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      Node* old = nullptr;
      {
        const std::lock_guard lock(head_lock_);
        Node* next = head_->next;
        if (next == nullptr) return false;
        task = next->value;
        old = head_;
        head_ = next;
      }
      delete old;
      return true;
    }

   private:
    struct Node {
      T value{};
      std::conditional_t<atomic_next, std::atomic<Node*>, Node*> next{nullptr};
    };
    std::mutex head_lock_;
    std::mutex tail_lock_;
    alignas(128) Node* head_;
    alignas(128) Node* tail_;
  };
};

/// `waits_for_next` is the healthy twin. M13: a consumer who has used up a page moves on although
/// the next one is not linked yet, and loses the chain.
template <bool waits_for_next>
struct Paged {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "pages of four, a lock for each end";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/)
        : head_(new Page), tail_(head_), all_(head_) {}
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    ~Queue() {
      while (all_ != nullptr) {
        Page* next = all_->next;
        delete all_;
        all_ = next;
      }
    }

    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(tail_lock_);
      unsigned filled = tail_->filled;
      if (filled == tail_->slots.size()) {
        Page* page = new Page;
        tail_->next = page;
        tail_ = page;
        filled = 0;
      }
      tail_->slots[filled] = task;
      tail_->filled = filled + 1;
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(head_lock_);
      if (head_ != nullptr && read_ == head_->slots.size()) {
        Page* next = head_->next;
        if (waits_for_next && next == nullptr) return false;
        head_ = next;
        read_ = 0;
      }
      if (head_ == nullptr || read_ == head_->filled) return false;
      task = head_->slots[read_++];
      return true;
    }

   private:
    struct Page {
      std::array<T, 4> slots{};
      std::atomic<unsigned> filled{0};
      std::atomic<Page*> next{nullptr};
    };
    std::mutex head_lock_;
    std::mutex tail_lock_;
    alignas(128) Page* head_;
    unsigned read_ = 0;
    alignas(128) Page* tail_;
    Page* all_;
  };
};

}  // namespace irt::stress
