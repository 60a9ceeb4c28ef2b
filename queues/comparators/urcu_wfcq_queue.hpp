/// liburcu's `wfcqueue`: wait-free push, locked pop.
///
/// When to use: many producers, one consumer or few; LOCK's list with the push's lock taken away.
/// When not: a producer may be stopped in the middle of a push; whoever pops then waits for it.
///
/// Ordering: FIFO by happens-before. Progress: push wait-free, apart from the allocator; pop
/// blocking. Memory: one node per task, deleted at once. Unbounded.
///
/// How it works: push exchanges the tail and then links its node behind the former one; between the
/// two the list has a gap, at which pop, under a mutex of its own, waits. The library's functions
/// are called, not inlined: it leaves inlining to programs under its own licence.
#pragma once

#include <cstddef>
#include <string_view>
#include <urcu/wfcqueue.h>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class UrcuWfcQueue {
 public:
  static constexpr std::string_view summary = "liburcu wfcqueue: wait-free push, locked pop";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free};

  UrcuWfcQueue(unsigned /*workers*/, std::size_t /*capacity*/) { cds_wfcq_init(&head_, &tail_); }
  UrcuWfcQueue(const UrcuWfcQueue&) = delete;
  UrcuWfcQueue& operator=(const UrcuWfcQueue&) = delete;

  ~UrcuWfcQueue() {
    T task{};
    while (pop(0, task)) {
    }
    cds_wfcq_destroy(&head_, &tail_);
  }

  /// Adds `task`. Wait-free. Always true.
  bool push(unsigned /*worker*/, T task) {
    auto* node = new Node;
    node->task = task;
    cds_wfcq_node_init(node);
    cds_wfcq_enqueue(cds_wfcq_head_cast(&head_), &tail_, node);
    return true;
  }

  /// Takes the oldest task; false if it sees none. Blocking: waits for other pops, and for a push
  /// that is between its two steps.
  bool pop(unsigned /*worker*/, T& task) {
    cds_wfcq_node* const first = cds_wfcq_dequeue_blocking(&head_, &tail_);
    if (first == nullptr) return false;
    auto* node = static_cast<Node*>(first);
    task = node->task;
    delete node;
    return true;
  }

 private:
  struct Node : cds_wfcq_node {
    T task{};
  };

  alignas(cache_line_pair) cds_wfcq_head head_{};
  alignas(cache_line_pair) cds_wfcq_tail tail_{};
};

}  // namespace irt
