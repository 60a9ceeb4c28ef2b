/// Vyukov's list for many producers and one consumer (2010, "Non-intrusive MPSC node-based queue",
/// 1024cores.net).
///
/// When to use: many threads hand tasks to one, as to an actor or an I/O thread. When not: a
/// producer may be stopped in the middle of a push, for then the tasks pushed after its own are not
/// seen until it goes on.
///
/// Ordering: FIFO by happens-before; *empty* may stand for a push in flight. Progress: push
/// wait-free, apart from the allocator; pop wait-free. Memory: one node per task, deleted at once.
/// Unbounded.
///
/// How it works: a push takes its turn by exchanging the newest node for its own, and then links
/// the two. Between these steps the list is in two parts, and the consumer sees the older one. The
/// consumer keeps the node whose task it took last as the sentinel before the next.
#pragma once

#include <atomic>
#include <string_view>
#include <utility>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class MpscList {
 public:
  static constexpr std::string_view summary = "many producers, one consumer: Vyukov's list";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .empty = Answer::calls_in_flight,
                                 .consumers = Callers::one,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  MpscList(unsigned /*workers*/, std::size_t /*capacity*/) {}
  MpscList(const MpscList&) = delete;
  MpscList& operator=(const MpscList&) = delete;

  ~MpscList() {
    while (oldest_ != nullptr) {
      // relaxed: destruction is single-threaded
      Node* next = oldest_->next.load(std::memory_order_relaxed);
      delete oldest_;
      oldest_ = next;
    }
  }

  /// Adds `task` at the back. Wait-free. Always true.
  bool push(unsigned /*worker*/, T task) {
    Node* node = new Node{std::move(task)};
    // (1) acq_rel: pairs with this very line of mpsc_list.hpp in the next push, which writes to the
    // node that this one made
    Node* last = newest_.exchange(node, std::memory_order_acq_rel);
    // (2) release: pairs with (3), so that the task is read as written
    last->next.store(node, std::memory_order_release);
    return true;
  }

  /// Takes the oldest task; false if it sees none. Wait-free.
  bool pop(unsigned /*worker*/, T& task) {
    // (3) acquire: pairs with (2)
    Node* next = oldest_->next.load(std::memory_order_acquire);
    if (next == nullptr) return false;
    task = std::move(next->task);
    delete oldest_;
    oldest_ = next;
    return true;
  }

 private:
  struct Node {
    T task{};
    std::atomic<Node*> next{nullptr};
  };

  alignas(cache_line_pair) Node* oldest_ = new Node;  // the consumer's alone
  alignas(cache_line_pair) std::atomic<Node*> newest_{oldest_};
};

}  // namespace irt
