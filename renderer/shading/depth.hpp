/// How far away surfaces are.
#pragma once

#include "renderer/shading/surface_shader.hpp"

namespace irt {

/// White at the eye, black from twice the distance of the camera's target on.
class Depth final : public SurfaceShader {
 public:
  Depth(const Scene& scene, FrameBuffer& frame, const ShaderOptions& /*options*/)
      : SurfaceShader(scene, frame) {}

  static std::uint64_t rays_per_hit(const Scene& /*scene*/) { return 0; }
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override { return 1; }

  void on_hits(const Task& task, const Hits& hits, TaskSink& /*tasks*/) const override {
    const float black = 2 * length(scene_.camera.target - scene_.camera.eye);
    for_each_hit(task, hits, {}, [&](std::uint32_t lane, const Surface& /*surface*/) {
      const float distance = hits.t[lane] * length(task.rays.ray(lane).direction);
      const float grey = 1 - distance / black;
      return Vec3{grey, grey, grey};
    });
  }
};

}  // namespace irt
