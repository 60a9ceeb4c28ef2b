/// CAS: two counters, a loop of compare-and-swap for each operation: the ceiling of queues whose
/// two ends are moved that way. What FAA has over it is what retries cost.
///
/// When to use: as a line in every chart of throughput. When not: to carry anything.
///
/// Ordering: no elements, hence none; as many pops succeed as pushes did. Progress: lock-free.
/// Memory: none. Unbounded.
///
/// How it works: as `FetchAndAdd`; pop moves `popped_` only while it is below `pushed_`.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class CompareAndSwap {
 public:
  static constexpr std::string_view summary = "two counters, compare-and-swap loops";
  static constexpr Claims claims{
      .push = Progress::lock_free, .pop = Progress::lock_free, .carries_elements = false};

  CompareAndSwap(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Counts one up. Lock-free. Always true.
  bool push(unsigned /*worker*/, T /*task*/) {
    std::uint64_t seen = pushed_.load();
    while (!pushed_.compare_exchange_weak(seen, seen + 1)) {
    }
    return true;
  }

  /// Counts one down; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& /*task*/) {
    std::uint64_t seen = popped_.load();
    do {
      if (seen >= pushed_.load()) return false;
    } while (!popped_.compare_exchange_weak(seen, seen + 1));
    return true;
  }

 private:
  alignas(cache_line_pair) std::atomic<std::uint64_t> pushed_{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> popped_{0};
};

}  // namespace irt
