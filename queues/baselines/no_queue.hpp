/// DELAY: no queue at all. What is measured with it is the work between the operations and the
/// harness; what others take longer is their own.
///
/// When to use: as a line in every chart of throughput. When not: to carry anything, or where a run
/// ends when everything has been popped: every pop succeeds.
///
/// Ordering: no elements, hence none. Progress: wait-free. Memory: none. Unbounded.
#pragma once

#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class NoQueue {
 public:
  static constexpr std::string_view summary = "nothing shared, nothing done: the work alone";
  static constexpr Claims claims{
      .push = Progress::wait_free, .pop = Progress::wait_free, .carries_elements = false};

  NoQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Does nothing. Wait-free. Always true.
  bool push(unsigned /*worker*/, T task) {
    asm volatile("" : : "r"(task));  // so that what made the task is not optimised away
    return true;
  }

  /// Does nothing. Wait-free. Always true.
  bool pop(unsigned /*worker*/, T& /*task*/) { return true; }
};

}  // namespace irt
