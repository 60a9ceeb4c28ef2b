/// FAA: two counters, one fetch-and-add for each operation: the ceiling. A queue whose two ends are
/// one word each cannot be faster on the same machine.
///
/// When to use: as a line in every chart of throughput. When not: to carry anything.
///
/// Ordering: no elements, hence none; as many pops succeed as pushes did. Progress: wait-free.
/// Memory: none. Unbounded.
///
/// How it works: push raises `pushed_`. Pop raises `popped_` and has got one if the value before
/// was below `pushed_`; otherwise it takes the step back. `popped_` is thus never less than the
/// number of pops that got one, which are therefore never more than pushes. An empty queue is only
/// read.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class FetchAndAdd {
 public:
  static constexpr std::string_view summary = "two counters, fetch-and-add: the ceiling";
  static constexpr Claims claims{
      .push = Progress::wait_free, .pop = Progress::wait_free, .carries_elements = false};

  FetchAndAdd(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Counts one up. Wait-free. Always true.
  bool push(unsigned /*worker*/, T /*task*/) {
    pushed_.fetch_add(1);
    return true;
  }

  /// Counts one down; false if it sees none. Wait-free.
  bool pop(unsigned /*worker*/, T& /*task*/) {
    if (popped_.load() >= pushed_.load()) return false;
    if (popped_.fetch_add(1) < pushed_.load()) return true;
    popped_.fetch_sub(1);
    return false;
  }

 private:
  alignas(cache_line_pair) std::atomic<std::uint64_t> pushed_{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> popped_{0};
};

}  // namespace irt
