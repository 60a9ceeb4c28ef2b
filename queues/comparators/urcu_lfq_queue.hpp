/// liburcu's `rculfqueue`: Michael and Scott's algorithm under read-copy-update.
///
/// When to use: beside LFREE, to see what it costs to protect nodes by RCU in place of hazard
/// pointers. When not: a thread may be stopped inside an operation; from then on no memory comes
/// back.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator. Memory: one
/// node per task, freed by the library's thread after a grace period. Unbounded. Where there is
/// none for a sentinel the library ends the process.
///
/// How it works: while the queue is empty it holds a sentinel, which pop adds before it takes the
/// last task. A thread says when it reads (a store to a word of its own); `call_rcu` hands a node
/// to a thread that waits until all who read when it was handed over have finished.
#pragma once

#include <cstddef>
#include <string_view>
#include <urcu/rculfqueue.h>
#include <urcu/urcu-memb.h>

#include "queues/work_queue.hpp"

namespace irt {
namespace urcu {

/// The library must know each thread that reads, once.
inline void register_thread() {
  struct Registered {
    Registered() { urcu_memb_register_thread(); }
    ~Registered() { urcu_memb_unregister_thread(); }
  };
  static thread_local const Registered registered;
}

}  // namespace urcu

template <class T>
class UrcuLfQueue {
 public:
  static constexpr std::string_view summary = "liburcu rculfqueue: Michael and Scott's under RCU";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::epochs,
                                 .survives_no_memory = false};

  UrcuLfQueue(unsigned /*workers*/, std::size_t /*capacity*/) {
    cds_lfq_init_rcu(&queue_, urcu_memb_call_rcu);
  }
  UrcuLfQueue(const UrcuLfQueue&) = delete;
  UrcuLfQueue& operator=(const UrcuLfQueue&) = delete;

  ~UrcuLfQueue() {
    T task{};
    while (pop(0, task)) {
    }
    cds_lfq_destroy_rcu(&queue_);
    urcu_memb_barrier();
  }

  /// Adds `task`. Lock-free. Always true.
  bool push(unsigned /*worker*/, T task) {
    urcu::register_thread();
    auto* node = new Node;
    node->task = task;
    cds_lfq_node_init_rcu(node);
    urcu_memb_read_lock();
    cds_lfq_enqueue_rcu(&queue_, node);
    urcu_memb_read_unlock();
    return true;
  }

  /// Takes the oldest task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) {
    urcu::register_thread();
    urcu_memb_read_lock();
    cds_lfq_node_rcu* const first = cds_lfq_dequeue_rcu(&queue_);
    urcu_memb_read_unlock();
    if (first == nullptr) return false;
    auto* node = static_cast<Node*>(first);
    task = node->task;
    urcu_memb_call_rcu(&node->retired, [](rcu_head* retired) {
      delete static_cast<Node*>(reinterpret_cast<Retired*>(retired));
    });
    return true;
  }

 private:
  struct Retired {
    rcu_head retired;  // first, so that its address is this one's
  };
  struct Node : Retired, cds_lfq_node_rcu {
    T task{};
  };

  cds_lfq_queue_rcu queue_{};
};

}  // namespace irt
