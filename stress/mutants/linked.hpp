/// Michael and Scott's queue with hazard pointers, and what people get wrong in it.
///
/// The healthy twin uses seq_cst where Dekker's pattern needs it and no fences, so that
/// ThreadSanitizer can judge it. Reclamation is eager (a scan every four nodes) to make reuse
/// likely.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::stress {

enum class LinkedBug {
  none,
  delete_now,        ///< M01: the old sentinel is deleted right after the head moved
  late_value,        ///< M04: the value is read after the move, when the node is not protected
  relaxed_publish,   ///< M05: the node is linked with a relaxed compare-and-swap
  acquire_head,      ///< M07: the head moves with acquire only
  hazard_release,    ///< M11: the hazard pointer is a release store: the re-read may overtake it
  scan_unordered,    ///< M11b: the scan's loads are not ordered after the unlinking
  scan_only_active,  ///< M12: the scan skips threads whose flag, set after the hazard, is off
};

template <LinkedBug bug>
struct Linked {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "Michael and Scott's queue, hazard pointers";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .push = Progress::lock_free,
                                   .pop = Progress::lock_free,
                                   .reclamation = Reclamation::hazard_pointers};

    Queue(unsigned workers, std::size_t /*capacity*/) : hazards_(workers) {
      head_ = tail_ = new Node{};
    }
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    ~Queue() {
      for (const Hazards& mine : hazards_) {
        for (Node* node : mine.retired) delete node;
      }
      for (Node* node = head_; node != nullptr;) {
        Node* next = node->next;
        delete node;
        node = next;
      }
    }

    bool push(unsigned worker, T task) {
      Node* node = new Node{};
      node->value = task;
      for (;;) {
        Node* last = protect(worker, 0, tail_);
        Node* next = last->next.load(std::memory_order_acquire);
        if (next != nullptr) {
          tail_.compare_exchange_strong(last, next);
          continue;
        }
        constexpr auto publish = bug == LinkedBug::relaxed_publish ? std::memory_order_relaxed
                                                                   : std::memory_order_release;
        if (last->next.compare_exchange_strong(next, node, publish, std::memory_order_relaxed)) {
          constexpr auto move = bug == LinkedBug::relaxed_publish ? std::memory_order_relaxed
                                                                  : std::memory_order_seq_cst;
          tail_.compare_exchange_strong(last, node, move);
          clear(worker);
          return true;
        }
      }
    }

    bool pop(unsigned worker, T& task) {
      for (;;) {
        Node* first = protect(worker, 0, head_);
        // In one order with the scan: who then still finds `first` in the tail has its hazard seen.
        Node* last = tail_.load();
        Node* next = protect(worker, 1, first->next);
        if (head_.load() != first) continue;
        if (next == nullptr) {
          clear(worker);
          return false;
        }
        if (first == last) {
          tail_.compare_exchange_strong(last, next);
          continue;
        }
        T value = next->value;
        if (bug != LinkedBug::delete_now) make_room(worker);
        constexpr auto move = bug == LinkedBug::acquire_head     ? std::memory_order_acquire
                              : bug == LinkedBug::scan_unordered ? std::memory_order_acq_rel
                                                                 : std::memory_order_seq_cst;
        if (!head_.compare_exchange_strong(first, next, move, std::memory_order_relaxed)) continue;
        clear(worker);
        if (bug == LinkedBug::late_value) value = next->value;
        task = value;
        if (bug == LinkedBug::delete_now) {
          delete first;
        } else {
          retire(worker, first);
        }
        return true;
      }
    }

   private:
    struct Node {
      T value{};
      std::atomic<Node*> next{nullptr};
    };
    struct alignas(128) Hazards {
      std::array<std::atomic<Node*>, 2> slots{};
      std::atomic<bool> active{false};
      std::vector<Node*> retired{};
      std::vector<Node*> named{};  ///< what scans found, kept for its room
    };

    Node* protect(unsigned worker, std::size_t slot, const std::atomic<Node*>& source) {
      constexpr auto order =
          bug == LinkedBug::hazard_release ? std::memory_order_release : std::memory_order_seq_cst;
      for (;;) {
        Node* node = source.load(std::memory_order_relaxed);
        hazards_[worker].slots[slot].store(node, order);
        if (source.load() != node) continue;
        if (bug == LinkedBug::scan_only_active) hazards_[worker].active = true;
        return node;
      }
    }

    void clear(unsigned worker) {
      for (auto& slot : hazards_[worker].slots) slot.store(nullptr, std::memory_order_release);
      if (bug == LinkedBug::scan_only_active) hazards_[worker].active = false;
    }

    // For one more retired node and a scan, before anything has happened that no memory could not
    // undo.
    void make_room(unsigned worker) {
      auto& retired = hazards_[worker].retired;
      if (retired.size() == retired.capacity()) retired.reserve(2 * retired.size() + 4);
      hazards_[worker].named.reserve(hazards_.size() * std::size(hazards_[worker].slots));
    }

    void retire(unsigned worker, Node* node) {
      auto& retired = hazards_[worker].retired;
      retired.push_back(node);
      if (retired.size() % 4 != 0) return;
      constexpr auto order =
          bug == LinkedBug::scan_unordered ? std::memory_order_acquire : std::memory_order_seq_cst;
      std::vector<Node*>& named = hazards_[worker].named;
      named.clear();
      for (const Hazards& other : hazards_) {
        if (bug == LinkedBug::scan_only_active && !other.active) continue;
        for (const auto& slot : other.slots) named.push_back(slot.load(order));
      }
      const auto kept = std::partition(retired.begin(), retired.end(), [&](Node* candidate) {
        return std::find(named.begin(), named.end(), candidate) != named.end();
      });
      std::for_each(kept, retired.end(), [](Node* free) { delete free; });
      retired.erase(kept, retired.end());
    }

    alignas(128) std::atomic<Node*> head_;
    alignas(128) std::atomic<Node*> tail_;
    std::vector<Hazards> hazards_;
  };
};

}  // namespace irt::stress
