#include "renderer/bvh/brute_force.hpp"

#include "renderer/bvh/triangles.hpp"

namespace irt {

BruteForce::BruteForce(const Mesh& mesh, const AcceleratorOptions& options)
    : SingleRayAccelerator("none", options), triangles_(corners(mesh)) {}

bool BruteForce::refit(const Mesh& mesh, Executor& /*executor*/) {
  triangles_ = corners(mesh);
  return true;
}

template <class Kernel, bool any, class Probe>
Hit BruteForce::trace(const KernelRay<Kernel>& ray, Probe& probe) const {
  Hit best = no_hit(ray);
  probe.test_begins();
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    ray.meet(triangles_[i], static_cast<std::uint32_t>(i), best);
    if (any && best.triangle != no_triangle) break;
  }
  probe.test_ends();
  return best;
}

template class SingleRayAccelerator<BruteForce>;

}  // namespace irt
