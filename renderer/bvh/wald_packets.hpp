/// Whole tasks through Wald's hierarchy: what the structure sees of it, and the nodes it walks.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/ray_loop.hpp"
#include "renderer/tracing/intersection.hpp"

namespace irt {

/// No leaf lies deeper, counted in steps from the root.
inline constexpr int wald_most_depth = 92;

/// Listing 5.2. A node with triangles is a leaf.
struct WaldNode {
  Vec3 box_min;
  std::uint32_t first;  ///< the first of two children, or of the triangles
  Vec3 box_max;
  std::uint16_t triangles;
  std::uint8_t axis;       ///< the children are furthest apart along it
  std::uint8_t low_child;  ///< which of them is lower there: 0 or 1

  [[nodiscard]] Box box() const { return {box_min, box_max}; }
};
static_assert(sizeof(WaldNode) == 32);

/// A triangle in the order of the leaves.
struct WaldTriangle {
  Triangle corners;
  std::uint32_t index;
};

struct WaldView {
  std::span<const WaldNode> nodes;
  std::span<const WaldTriangle> triangles;
};

/// The two queries, compiled for one instruction set, kernel and width. Without a probe the pointer
/// is null.
struct WaldPackets {
  void (*closest)(WaldView tree, const Rays& rays, Hits& hits, TickProbe* probe);
  void (*any)(WaldView tree, const Rays& rays, std::span<std::uint8_t> occluded, TickProbe* probe);
};

/// The code for `isa` of AcceleratorOptions and a `width` of 4, 8 or 16. Throws
/// std::invalid_argument where the machine lacks it.
const WaldPackets* wald_packets(std::string_view isa, TriangleKernel kernel, unsigned width);

}  // namespace irt
