/// Michael and Scott's queue as they published it (1996, "Simple, Fast, and Practical Non-Blocking
/// and Blocking Concurrent Queue Algorithms", figure 1): with counted links, and a free list.
///
/// When to use: as LFREE, where nodes should be used again at once and no thread should pay for
/// others being protected. When not: the peak length matters, since its nodes are kept; elements
/// are more than a word.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator while the free
/// list is empty. Memory: 16 bytes for each of the most tasks that were inside at once, up to twice
/// that, kept for reuse. Unbounded, up to 2^32 tasks.
///
/// How it works: as michael_scott_queue.hpp, but a node that has left is another one at once, and
/// whoever has read something of it must find out. Each link carries a count that grows with every
/// change. A push looks at the last node's link and then whether that node is still the last; only
/// then does it believe the link, and its compare-and-swap fails if the link has changed since. A
/// pop looks in the same way at the first node's link. The task, too, it reads before it knows; it
/// gives it out if the head is then still as it was. See tagged_free_list.hpp for when two counts
/// are equal by chance.
///
/// What differs from the paper, and why:
/// - Links are numbers with counts, see tagged_free_list.hpp.
/// - *Empty* needs no look at the tail, as in michael_scott_queue.hpp.
/// - All shared fields are atomic, with the weakest orders that do.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "queues/cache_line.hpp"
#include "queues/reclamation/reclaimer.hpp"
#include "queues/reclamation/tagged_free_list.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class CountedMichaelScottQueue {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= sizeof(std::uint64_t),
                "a task is read while its node may already be another one's: it has to be a word");

  struct Node {
    std::atomic<std::uint64_t> word{0};
    std::atomic<TaggedLink> next{};
  };

  static constexpr Needs needs{.nodes = 2, .follows_retired = true, .checks_versions = true};
  static_assert(suits<TaggedFreeList<Node>::offers, needs>());

 public:
  static constexpr std::string_view summary = "LFREE, nodes reused at once, counted links";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::free_list};

  CountedMichaelScottQueue(unsigned /*workers*/, std::size_t /*capacity*/)
      : head_(TaggedLink{nodes_.take(), 0}),
        // relaxed: construction is single-threaded
        tail_(head_.load(std::memory_order_relaxed)) {}

  /// Adds `task` at the back. Lock-free. Always true.
  bool push(unsigned /*worker*/, T task) {
    const std::uint32_t node = nodes_.take();
    // relaxed: (2) publishes it
    nodes_[node].word.store(word_of(task), std::memory_order_relaxed);
    for (;;) {
      // (1) acquire: pairs with (5), so that the node is there
      const TaggedLink last = tail_.load(std::memory_order_acquire);
      std::atomic<TaggedLink>& link = nodes_[last.node].next;
      // (3) acquire: pairs with (2); and with the stores in tagged_free_list.hpp, so that who reads
      // a link of the node's later life sees below that the tail had left it
      TaggedLink next = link.load(std::memory_order_acquire);
      // relaxed: (3) says what must be seen
      if (tail_.load(std::memory_order_relaxed) != last) continue;
      if (next.node != 0) {
        move_tail(last, next.node);
        continue;
      }
      // (2) release: pairs with (3) and (6). relaxed on failure: nothing was read but a change
      if (link.compare_exchange_strong(next, next.then(node), std::memory_order_release,
                                       std::memory_order_relaxed)) {
        move_tail(last, node);
        return true;
      }
    }
  }

  /// Takes the oldest task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) {
    for (;;) {
      // (4) acquire: pairs with (7), so that the node is there and the tail no further back than it
      // was seen there
      TaggedLink first = head_.load(std::memory_order_acquire);
      // (8) acquire: pairs with (5), so that who finds this node there again, in a later life, sees
      // below that the head had left it
      const TaggedLink last = tail_.load(std::memory_order_acquire);
      // (6) acquire: pairs with (2), so that the task is read as written; and with the stores in
      // tagged_free_list.hpp, so that who reads a link of the node's later life sees below that the
      // head had left it
      const TaggedLink next = nodes_[first.node].next.load(std::memory_order_acquire);
      // relaxed: (6) and (8) say what must be seen
      if (head_.load(std::memory_order_relaxed) != first) continue;
      if (next.node == 0) return false;
      if (first.node == last.node) {
        move_tail(last, next.node);
        continue;
      }
      // relaxed: (6) says what must be seen; if the node is in use again, (7) fails
      const std::uint64_t word = nodes_[next.node].word.load(std::memory_order_relaxed);
      // (7) release: pairs with (4). relaxed on failure: nothing is read
      if (head_.compare_exchange_strong(first, first.then(next.node), std::memory_order_release,
                                        std::memory_order_relaxed)) {
        nodes_.give(first.node);
        task = element_of<T>(word);
        return true;
      }
    }
  }

 private:
  void move_tail(TaggedLink from, std::uint32_t to) {
    // (5) release: pairs with (1) and (8). relaxed on failure: another thread has done it
    tail_.compare_exchange_strong(from, from.then(to), std::memory_order_release,
                                  std::memory_order_relaxed);
  }

  TaggedFreeList<Node> nodes_;
  alignas(cache_line_pair) std::atomic<TaggedLink> head_;
  alignas(cache_line_pair) std::atomic<TaggedLink> tail_;
};

}  // namespace irt
