/// libcds' intrusive Michael-Scott queue, unmodified, without a garbage collector: nodes live until
/// the queue is destroyed. What is checked are the queue's own memory orders.
///
/// The library's hazard pointers are compiled code that keeps its state per operating-system
/// thread; the checker could neither see them nor tell virtual cores apart there.
#pragma once

#include <array>
#include <atomic>
#include <cds/intrusive/msqueue.h>
#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::checker {

/// A libcds garbage collector that collects nothing. Its reads are acquire, as the last read of the
/// library's own guards is.
struct KeepAll {
  template <class T>
  using atomic_ref = std::atomic<T*>;
  template <class T>
  using atomic_type = std::atomic<T>;
  template <class MarkedPtr>
  using atomic_marked_ptr = std::atomic<MarkedPtr>;

  struct Guard {
    template <class T, class Extract>
    static T protect(const std::atomic<T>& source, Extract) {
      return source.load(std::memory_order_acquire);
    }
  };
  template <std::size_t>
  struct GuardArray {
    template <class T, class Extract>
    static T protect(std::size_t, const std::atomic<T>& source, Extract) {
      return source.load(std::memory_order_acquire);
    }
  };
  template <class Disposer, class T>
  static void retire(T*) {}
  static void scan() {}
};

template <class T>
class LibcdsQueue {
 public:
  static constexpr std::string_view summary = "libcds intrusive::MSQueue, nodes kept";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::at_destruction};

  LibcdsQueue(unsigned workers, std::size_t /*capacity*/) : nodes_(workers) {}

  bool push(unsigned worker, T task) {
    nodes_[worker].push_back(std::make_unique<Node>());
    nodes_[worker].back()->task = task;
    return queue_.enqueue(*nodes_[worker].back());
  }

  bool pop(unsigned /*worker*/, T& task) {
    const Node* node = queue_.dequeue();
    if (node == nullptr) return false;
    task = node->task;
    return true;
  }

 private:
  struct Node : cds::intrusive::msqueue::node<KeepAll> {
    T task{};
  };
  struct Nothing {
    void operator()(Node*) const {}
  };
  struct Traits : cds::intrusive::msqueue::traits {
    using hook = cds::intrusive::msqueue::base_hook<cds::opt::gc<KeepAll>>;
    using disposer = Nothing;
  };

  std::vector<std::vector<std::unique_ptr<Node>>> nodes_;  // by the worker that pushed them
  cds::intrusive::MSQueue<KeepAll, Node, Traits> queue_;
};

}  // namespace irt::checker
