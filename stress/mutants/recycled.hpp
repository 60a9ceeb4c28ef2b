/// Michael and Scott's queue with nodes recycled through a LIFO free list, told apart by counters
/// in the upper bits of every pointer (figure 1 of their paper); and without the counters.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt::stress {

enum class RecycledBug {
  none,
  uncounted,  ///< M02: a delayed compare-and-swap takes a recycled node for the one it read (ABA)
  no_help,    ///< M09: the head may pass the tail, which then names a node that is used again
};

template <RecycledBug bug>
struct Recycled {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "Michael and Scott's queue, counted free list";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .push = Progress::lock_free,
                                   .pop = Progress::lock_free,
                                   .reclamation = Reclamation::free_list};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) { head_ = tail_ = word(take_node(), 0); }
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    ~Queue() {
      for (Node* node = all_; node != nullptr;) {
        Node* next = node->made_before;
        delete node;
        node = next;
      }
    }

    bool push(unsigned /*worker*/, T task) {
      Node* node = take_node();
      node->value = task;
      node->next = word(nullptr, tag(node->next) + 1);
      for (;;) {
        Word last = tail_;
        Word next = pointer(last)->next;
        if (last != tail_) continue;
        if (pointer(next) != nullptr) {
          tail_.compare_exchange_strong(last, word(pointer(next), tag(last) + 1));
        } else if (pointer(last)->next.compare_exchange_strong(next, word(node, tag(next) + 1))) {
          tail_.compare_exchange_strong(last, word(node, tag(last) + 1));
          return true;
        }
      }
    }

    bool pop(unsigned /*worker*/, T& task) {
      for (;;) {
        Word first = head_;
        Word last = tail_;
        const Word next = pointer(first)->next;
        if (first != head_) continue;
        if (pointer(next) == nullptr) return false;
        if (bug != RecycledBug::no_help && pointer(first) == pointer(last)) {
          tail_.compare_exchange_strong(last, word(pointer(next), tag(last) + 1));
          continue;
        }
        const T value = pointer(next)->value;
        if (head_.compare_exchange_strong(first, word(pointer(next), tag(first) + 1))) {
          task = value;
          give_node(pointer(first));
          return true;
        }
      }
    }

   private:
    using Word = std::uint64_t;
    static constexpr unsigned tag_shift = 48;
    struct Node {
      std::atomic<T> value{};
      std::atomic<Word> next{0};
      Node* made_before = nullptr;
    };

    static Word word(Node* node, Word tag) {
      return reinterpret_cast<Word>(node) | (bug == RecycledBug::uncounted ? 0 : tag << tag_shift);
    }
    static Node* pointer(Word w) {
      // A counted pointer: the lower 48 bits are the address.
      // NOLINTNEXTLINE(performance-no-int-to-ptr)
      return reinterpret_cast<Node*>(w & ((Word{1} << tag_shift) - 1));
    }
    static Word tag(Word w) { return w >> tag_shift; }

    Node* take_node() {
      for (Word top = free_; pointer(top) != nullptr;) {
        const Word below = pointer(top)->next;
        if (free_.compare_exchange_weak(top, word(pointer(below), tag(top) + 1)))
          return pointer(top);
      }
      Node* node = new Node;
      node->made_before = all_;
      while (!all_.compare_exchange_weak(node->made_before, node)) {
      }
      return node;
    }

    void give_node(Node* node) {
      Word top = free_;
      do {
        node->next = word(pointer(top), tag(node->next) + 1);
      } while (!free_.compare_exchange_weak(top, word(node, tag(top) + 1)));
    }

    alignas(128) std::atomic<Word> head_;
    alignas(128) std::atomic<Word> tail_;
    alignas(128) std::atomic<Word> free_{0};
    std::atomic<Node*> all_{nullptr};
  };
};

}  // namespace irt::stress
