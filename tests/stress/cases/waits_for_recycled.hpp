/// OpenDataPlane/odp#1639 (2022): a dequeuer waits for the `next` of the node it has seen at the
/// head without looking at the head again; the node was taken, recycled, and is now the last one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool Fixed, int writes_before = 0>
class WaitsForRecycledCase {
 public:
  static constexpr std::string_view summary =
      "linked list in an array, head and tail in one word (odp#1639)";
  // Not fifo_real_time: "full" counts a push that has a node but is not linked yet, "empty" does
  // not.
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::free_list};

  WaitsForRecycledCase(unsigned /*workers*/, std::size_t capacity)
      : nodes_(std::max<std::size_t>(capacity, 1)) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) give(i);
  }

  bool push(unsigned /*worker*/, T task) {
    std::uint64_t mine = none;
    if (!take(mine)) return false;
    nodes_[mine].task = task;
    nodes_[mine].next.store(none);
    std::uint64_t ends = ends_.load();
    std::uint64_t fresh = 0;
    do {
      fresh = pack(tail(ends) == none ? mine : head(ends), mine, ends);
    } while (!ends_.compare_exchange_weak(ends, fresh));
    if (tail(ends) != none) nodes_[tail(ends)].next.store(mine);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    std::uint64_t ends = ends_.load();
    for (;;) {
      const std::uint64_t first = head(ends);
      if (first == none) return false;
      std::uint64_t fresh = pack(none, none, ends);
      if (first != tail(ends)) {
        std::uint64_t next = nodes_[first].next.load();
        bool moved = false;
        if (writes_before == 1 && next == none) waited_.fetch_add(1, std::memory_order_relaxed);
        if (writes_before == 2 && next == none) waited_.store(first + 1, std::memory_order_relaxed);
        while (next == none && !moved) {  // a push is between its two steps
          std::this_thread::yield();
          if (Fixed) {
            const std::uint64_t now = ends_.load();
            moved = now != ends;
            if (moved) ends = now;
          }
          if (!moved) next = nodes_[first].next.load();
        }
        if (moved) continue;
        fresh = pack(next, tail(ends), ends);
      }
      if (ends_.compare_exchange_weak(ends, fresh)) {
        task = nodes_[first].task;
        give(first);
        return true;
      }
    }
  }

 private:
  // Three fields in a word: a counter, the tail, the head.
  static constexpr std::uint64_t bits = 20;
  static constexpr std::uint64_t none = (1U << bits) - 1;
  static std::uint64_t head(std::uint64_t word) { return word & none; }
  static std::uint64_t tail(std::uint64_t word) { return word >> bits & none; }
  static std::uint64_t pack(std::uint64_t first, std::uint64_t last, std::uint64_t before) {
    return ((before >> 2 * bits) + 1) << 2 * bits | last << bits | first;
  }

  struct Node {
    std::atomic<std::uint64_t> next{none};
    std::atomic<std::uint64_t> below{none};
    T task{};
  };

  bool take(std::uint64_t& node) {
    std::uint64_t top = free_.load();
    do {
      node = head(top);
      if (node == none) return false;
    } while (!free_.compare_exchange_weak(top, pack(nodes_[node].below.load(), 0, top)));
    return true;
  }
  void give(std::uint64_t node) {
    std::uint64_t top = free_.load();
    do {
      nodes_[node].below.store(head(top));
    } while (!free_.compare_exchange_weak(top, pack(node, 0, top)));
  }

  std::vector<Node> nodes_;
  alignas(128) std::atomic<std::uint64_t> ends_{none << bits | none};
  alignas(128) std::atomic<std::uint64_t> free_{none};
  alignas(128) std::atomic<std::uint64_t> waited_{0};
};

template <class T>
class WaitsForRecycledBug : public WaitsForRecycledCase<T, false> {
  using WaitsForRecycledCase<T, false>::WaitsForRecycledCase;
};
template <class T>
class WaitsForRecycledFixed : public WaitsForRecycledCase<T, true> {
  using WaitsForRecycledCase<T, true>::WaitsForRecycledCase;
};

/// The bug again, with a statistic written before the loop: to see what the checker makes of that.
template <class T>
class WaitsForRecycledCountedBug : public WaitsForRecycledCase<T, false, 1> {
  using WaitsForRecycledCase<T, false, 1>::WaitsForRecycledCase;
};
/// And with a plain store there.
template <class T>
class WaitsForRecycledStoredBug : public WaitsForRecycledCase<T, false, 2> {
  using WaitsForRecycledCase<T, false, 2>::WaitsForRecycledCase;
};

}  // namespace irt
