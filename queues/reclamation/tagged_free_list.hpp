/// A free list whose nodes are used again at once, told apart by counts (Treiber 1986, "Systems
/// Programming: Coping with Parallelism", for the list; the counts are IBM's, as in Michael and
/// Scott 1996). Boost.Lockfree reclaims in this way.
///
/// When to use: nodes are small and of one kind, a structure's peak length may stay allocated, and
/// no memory should wait for anybody. When not: what is in a node is no atomic word, for it is read
/// while it may be written to; or tools should see a node that is used too early.
///
/// Progress: lock-free, apart from the allocator when all nodes are in use. Memory: as many nodes
/// as have been in use at once, up to twice that; returned at destruction.
///
/// How it works: a node is known by a number, and a link is the number with a count in one word of
/// eight bytes. Every change of a link adds one to its count, also when the node has become another
/// one meanwhile, so a compare-and-swap that expects the old one fails. Spare nodes are a stack of
/// such links. The nodes stand in blocks, each as large as all before it together.
///
/// What differs from Boost.Lockfree, and why: there a link is a pointer with a count in the 16 bits
/// that addresses leave unused, and is taken for the old one after exactly 65,536 changes. Numbers
/// of 32 bits leave 32 for the count. A pointer with a count of 64 bits would need a 16-byte
/// compare-and-swap, which GCC also uses to read one.
///
/// Not done: a thread that is stopped between reading a link and its compare-and-swap, while the
/// link changes exactly 2^32 times, or a multiple of that, and has the same number again, takes it
/// for the old one.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>

#include "queues/cache_line.hpp"
#include "queues/reclamation/reclaimer.hpp"

namespace irt {

/// Which node, and the how-many-th link this is in its place.
struct alignas(sizeof(std::uint64_t)) TaggedLink {
  std::uint32_t node = 0;  ///< 0: none
  std::uint32_t count = 0;

  /// The link that follows this one in its place, to another node.
  [[nodiscard]] TaggedLink then(std::uint32_t other) const { return {other, count + 1}; }
  [[nodiscard]] bool operator==(const TaggedLink&) const = default;
};

static_assert(std::atomic<TaggedLink>::is_always_lock_free);

/// `Node` has an atomic TaggedLink `next`, which is the structure's while the node is in use.
template <class Node>
class TaggedFreeList {
 public:
  static constexpr Offers offers{
      .nodes = any_number, .follows_retired = true, .reuses_at_once = true};

  TaggedFreeList() = default;
  TaggedFreeList(const TaggedFreeList&) = delete;
  TaggedFreeList& operator=(const TaggedFreeList&) = delete;

  ~TaggedFreeList() {
    // relaxed: destruction is single-threaded
    for (const std::atomic<Node*>& block : blocks_) delete[] block.load(std::memory_order_relaxed);
  }

  /// The node of that number, which may be spare by now. Wait-free.
  Node& operator[](std::uint32_t number) {
    // relaxed: who knows the number has it from who knew the block
    return block_of(number).load(std::memory_order_relaxed)[number - std::bit_floor(number)];
  }

  /// The number of a node that nobody else uses, with a null link. Others may still read it, and
  /// believe nothing of it. Lock-free, apart from the allocator.
  std::uint32_t take() {
    for (;;) {
      // (1) acquire: pairs with (3), so that the link below is the one that was written for this
      // top, and the node not used by who gave it any more
      const TaggedLink seen = spare_.load(std::memory_order_acquire);
      if (seen.node == 0) return make();
      Node& node = (*this)[seen.node];
      // relaxed: (1) says what must be seen; if the node is in use by now, the next line fails
      const TaggedLink below = node.next.load(std::memory_order_relaxed);
      TaggedLink top = seen;
      // relaxed: this top, count and all, was read before
      if (spare_.compare_exchange_weak(top, seen.then(below.node), std::memory_order_relaxed)) {
        // (2) release: pairs with the looks in counted_michael_scott_queue.hpp, so that who reads
        // this link sees that the node had left the structure before
        node.next.store(below.then(0), std::memory_order_release);
        return seen.node;
      }
    }
  }

  /// Back to the spare ones. Lock-free.
  void give(std::uint32_t number) {
    Node& node = (*this)[number];
    // relaxed, twice: the node is nobody else's; what the top is (3) confirms
    TaggedLink link = node.next.load(std::memory_order_relaxed);
    TaggedLink top = spare_.load(std::memory_order_relaxed);
    do {
      link = link.then(top.node);
      // (4) release: pairs with the looks in counted_michael_scott_queue.hpp, for the same end
      node.next.store(link, std::memory_order_release);
      // (3) release: pairs with (1). relaxed on failure: nothing is read but the top
    } while (!spare_.compare_exchange_weak(top, top.then(number), std::memory_order_release,
                                           std::memory_order_relaxed));
  }

 private:
  // A block for each length of numbers, in bits.
  std::atomic<Node*>& block_of(std::uint32_t number) {
    return blocks_[static_cast<std::size_t>(std::bit_width(number))];
  }

  std::uint32_t make() {
    // relaxed: numbers are given once by being changed, whatever the order
    std::uint32_t made = made_.load(std::memory_order_relaxed);
    do {
      if (made == std::numeric_limits<std::uint32_t>::max()) throw std::bad_alloc();
      provide(made + 1);
      // relaxed: as above
    } while (!made_.compare_exchange_weak(made, made + 1, std::memory_order_relaxed));
    return made + 1;
  }

  // Sees to it that the node of that number is there.
  void provide(std::uint32_t number) {
    std::atomic<Node*>& block = block_of(number);
    Node* there = nullptr;
    // (5) acquire: pairs with (6), so that the nodes have been made when they are used
    if (block.load(std::memory_order_acquire) != there) return;
    auto nodes = std::make_unique<Node[]>(std::bit_floor(number));
    // (6) release: pairs with (5) and (7)
    // (7) acquire: on failure, where another thread was first; pairs with (6)
    if (block.compare_exchange_strong(there, nodes.get(), std::memory_order_release,
                                      std::memory_order_acquire))
      nodes.release();
  }

  std::array<std::atomic<Node*>, 33> blocks_{};
  alignas(cache_line_pair) std::atomic<TaggedLink> spare_{};
  alignas(cache_line_pair) std::atomic<std::uint32_t> made_{0};
};

}  // namespace irt
