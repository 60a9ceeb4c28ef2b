/// No structure at all.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/bvh/single_ray.hpp"

namespace irt {

/// Tests every ray against every triangle: the thesis' starting point ("scalar with no ADS",
/// table 5.2) and the oracle that all structures are compared with.
///
/// Use it for a handful of triangles or as a reference; 100,000 triangles cost some 0.3 ms a ray.
class BruteForce final : public SingleRayAccelerator<BruteForce> {
 public:
  BruteForce(const Mesh& mesh, const AcceleratorOptions& options);

  template <class Kernel, bool any, class Probe>
  Hit trace(const KernelRay<Kernel>& ray, Probe& probe) const;

  [[nodiscard]] std::size_t memory_bytes() const override {
    return triangles_.size() * sizeof(Triangle);
  }
  bool refit(const Mesh& mesh, Executor& executor) override;

 private:
  std::vector<Triangle> triangles_;
};

}  // namespace irt
