/// The hierarchy of thesis 5.2.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/bvh/single_ray.hpp"

namespace irt {

/// A binary bounding volume hierarchy in one array of 32-byte nodes (thesis 5.2, listing 5.2, after
/// Wald, Boulos, Shirley 2007, "Ray tracing deformable scenes using dynamic bounding volume
/// hierarchies").
///
/// Use it to compare with the thesis, and where memory counts: 32 bytes per node and no pointer.
/// Its build sorts at every node and is the slowest of all.
///
/// Built top-down with the full surface area heuristic: at every node the triangles are sorted by
/// their centres along each axis, as in the thesis by quicksort (std::sort), and each of the n - 1
/// partitions per axis is priced. A ray enters first the child that lies on its side of the axis
/// along which the two are furthest apart.
///
/// Below a depth that no useful tree reaches, lists are halved, which bounds it.
class Wald final : public SingleRayAccelerator<Wald> {
 public:
  Wald(const Mesh& mesh, const AcceleratorOptions& options);

  template <class Kernel, bool any, class Probe>
  Hit trace(const KernelRay<Kernel>& ray, Probe& probe) const;

  std::size_t memory_bytes() const override {
    return nodes_.size() * sizeof(Node) + triangles_.size() * sizeof(Leaf);
  }

 private:
  /// Listing 5.2. A node with triangles is a leaf.
  struct Node {
    Vec3 box_min;
    std::uint32_t first;  ///< the first of two children, or of the triangles
    Vec3 box_max;
    std::uint16_t triangles;
    std::uint8_t axis;       ///< the children are furthest apart along it
    std::uint8_t low_child;  ///< which of them is lower there: 0 or 1

    Box box() const { return {box_min, box_max}; }
  };
  static_assert(sizeof(Node) == 32);

  /// A triangle in the order of the leaves.
  struct Leaf {
    Triangle corners;
    std::uint32_t index;
  };
  struct Builder;

  std::vector<Node> nodes_;  ///< the root first, then children in pairs
  std::vector<Leaf> triangles_;
};

}  // namespace irt
