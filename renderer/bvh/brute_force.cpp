#include "renderer/bvh/brute_force.hpp"

#include "renderer/bvh/triangles.hpp"

namespace irt {

BruteForce::BruteForce(const Mesh& mesh) : triangles_(corners(mesh)) {}

template <bool any, class Probe>
Hit BruteForce::trace(const TraversalRay& ray, Probe& probe) const {
  Hit best = no_hit(ray);
  if (best.t < 0) return best;
  probe.test_begins();
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    meet(triangles_[i], static_cast<std::uint32_t>(i), ray, best);
    if (any && best.triangle != no_triangle) break;
  }
  probe.test_ends();
  return best;
}

template class SingleRayAccelerator<BruteForce>;

}  // namespace irt
