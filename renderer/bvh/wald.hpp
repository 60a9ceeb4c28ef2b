/// The hierarchy of thesis 5.2.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/bvh/single_ray.hpp"
#include "renderer/bvh/wald_packets.hpp"

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
///
/// Rays walk one by one, as in the thesis, or with a packet width of 4, 8 or 16 by whole tasks: the
/// traversal that the paper made the structure for and that the thesis left as future work.
class Wald final : public SingleRayAccelerator<Wald> {
 public:
  Wald(const Mesh& mesh, const AcceleratorOptions& options);

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const override;
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile) const override;

  template <class Kernel, bool any, class Probe>
  Hit trace(const KernelRay<Kernel>& ray, Probe& probe) const;

  [[nodiscard]] std::size_t memory_bytes() const override {
    return nodes_.size() * sizeof(WaldNode) + triangles_.size() * sizeof(WaldTriangle);
  }
  bool refit(const Mesh& mesh, Executor& executor) override;
  [[nodiscard]] double sah_cost() const override { return sah_cost_; }

 private:
  struct Builder;

  const WaldPackets* packets_;   ///< null: rays walk one by one
  std::vector<WaldNode> nodes_;  ///< the root first, then children in pairs
  std::vector<WaldTriangle> triangles_;
  double sah_cost_ = 1;  ///< boxes that a ray which enters the root is expected to enter
};

}  // namespace irt
