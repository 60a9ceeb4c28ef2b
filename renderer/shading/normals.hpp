/// Which way surfaces face.
#pragma once

#include "renderer/shading/surface_shader.hpp"

namespace irt {

/// x, y and z of the normal that looks at the viewer, from [-1, 1] to red, green and blue. Shows
/// at a glance what a reader or a generator has done to a mesh.
class Normals final : public SurfaceShader {
 public:
  Normals(const Scene& scene, FrameBuffer& frame, const ShaderOptions& /*options*/)
      : SurfaceShader(scene, frame) {}

  static std::uint64_t rays_per_hit(const Scene& /*scene*/) { return 0; }
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override { return 1; }

  void on_hits(const Task& task, const Hits& hits, TaskSink& /*tasks*/) const override {
    for_each_hit(task, hits, {}, [](std::uint32_t /*lane*/, const Surface& surface) {
      return surface.normal * 0.5f + Vec3{0.5f, 0.5f, 0.5f};
    });
  }
};

}  // namespace irt
