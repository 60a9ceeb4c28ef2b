/// The layout of the wide hierarchy: nodes of eight boxes, leaves of a few triangles, both in
/// structures of arrays so that one SIMD instruction sees all boxes or triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "renderer/tracing/huge_pages.hpp"
#include "renderer/tracing/intersection.hpp"

namespace irt {

inline constexpr int wide_fanout = 8;
inline constexpr int wide_block = 4;  ///< triangles per block
inline constexpr int wide_most_in_leaf = 8;
/// Levels that the builder splits by cost; below, it halves, which adds at most 32 levels.
inline constexpr int wide_cost_depth = 48;
inline constexpr int wide_most_depth = wide_cost_depth + 32;

/// What a node's child is, in 32 bits: an inner node's index, or a leaf's first block and number
/// of triangles.
class WideChild {
 public:
  static constexpr WideChild inner(std::uint32_t node) { return WideChild(node); }
  static constexpr WideChild leaf(std::uint32_t first_block, std::uint32_t count) {
    return WideChild(leaf_bit | (count - 1) << count_shift | first_block);
  }
  constexpr WideChild() = default;

  [[nodiscard]] constexpr bool is_leaf() const { return (bits_ & leaf_bit) != 0; }
  [[nodiscard]] constexpr std::uint32_t node() const { return bits_; }
  [[nodiscard]] constexpr std::uint32_t first_block() const {
    return bits_ & ((1u << count_shift) - 1);
  }
  /// Triangles in the leaf, in [1, wide_most_in_leaf].
  [[nodiscard]] constexpr std::uint32_t count() const {
    return ((bits_ & ~leaf_bit) >> count_shift) + 1;
  }
  /// The same child after its nodes and blocks have moved.
  [[nodiscard]] constexpr WideChild moved(std::uint32_t nodes, std::uint32_t blocks) const {
    return WideChild(bits_ + (is_leaf() ? blocks : nodes));
  }

 private:
  static constexpr std::uint32_t leaf_bit = 0x8000'0000u;
  static constexpr int count_shift = 28;
  explicit constexpr WideChild(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t bits_;  // no initializer: stacks of children are large
};
static_assert(wide_most_in_leaf <= 8, "a leaf's count has three bits");

/// Up to eight children. Lanes without one have an empty box, which no ray enters. A node is left
/// uninitialized by default, so that the threads of a build can be the first to touch its memory.
struct alignas(32) WideNode {
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  /// Lower x, y, z, then upper x, y, z, per child: a ray's sign selects rows, not lanes.
  float plane[6][wide_fanout];
  WideChild child[wide_fanout];

  static WideNode without_children() {
    WideNode node;
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < wide_fanout; ++i) {
        node.plane[axis][i] = infinity;
        node.plane[axis + 3][i] = -infinity;
      }
    }
    for (WideChild& none : node.child) none = WideChild::inner(0);
    return node;
  }
};

/// Four triangles. Lanes past the leaf's count repeat its last triangle, so that a test of all
/// lanes finds nothing that is not there.
struct alignas(32) WideBlock {
  float corner[3][3][wide_block];  ///< [corner][axis][lane]
  std::uint32_t index[wide_block];

  void set(int lane, std::uint32_t triangle, const float (&corners)[3][3]) {
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) corner[k][axis][lane] = corners[k][axis];
    }
    index[lane] = triangle;
  }
};

/// The triangles of a leaf.
struct WideLeaf {
  const WideBlock* blocks;
  std::uint32_t count;  ///< of triangles, in [1, wide_most_in_leaf]
};

/// Leaves what a vector grows by uninitialized.
template <class T>
struct Uninitialized : HugePageAllocator<T> {
  using HugePageAllocator<T>::HugePageAllocator;
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    if constexpr (sizeof...(Arguments) == 0) {
      ::new (static_cast<void*>(at)) U;
    } else {
      std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
  }
};

/// Nodes in depth-first order, the root first, and the blocks in the order of their leaves.
/// Without triangles there are no nodes.
struct WideBvh {
  std::vector<WideNode, Uninitialized<WideNode>> nodes;
  std::vector<WideBlock, Uninitialized<WideBlock>> blocks;
  /// Expected cost of a ray that enters the root: 1 per node and 1 per block of four triangles,
  /// each weighted by its share of the root's surface (MacDonald and Booth 1990).
  double sah_cost = 0;
  Box box;  ///< around everything

  [[nodiscard]] WideLeaf leaf(WideChild child) const {
    return {blocks.data() + child.first_block(), child.count()};
  }

  [[nodiscard]] std::size_t memory_bytes() const {
    return nodes.size() * sizeof(WideNode) + blocks.size() * sizeof(WideBlock);
  }
};

}  // namespace irt
