/// atomic_queue::AtomicQueue2 of two places, as it comes out of its package: a ring that wraps at
/// once. The one of queues/comparators has 4,096 places at least.
#pragma once

#include <atomic_queue/atomic_queue.h>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt::checker {

template <class T>
class SmallAtomicQueue {
 public:
  static constexpr std::string_view summary = "atomic_queue::AtomicQueue2, two places";
  /// `bounded` would promise to hold `capacity`; its size is a template argument.
  static constexpr Claims claims{
      .ordering = Ordering::unordered, .bounded = true, .reclamation = Reclamation::preallocated};

  SmallAtomicQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) { return queue_.try_push(task); }
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_pop(task); }

 private:
  atomic_queue::AtomicQueue2<T, 2, false> queue_;
};

}  // namespace irt::checker
