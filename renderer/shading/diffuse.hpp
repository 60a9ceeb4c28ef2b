/// The colour of matt surfaces under the lights, without shadows and mirrors.
#pragma once

#include "renderer/shading/surface_shader.hpp"
#include "renderer/shading/whitted.hpp"

namespace irt {

/// One ray per sample and none after it: every task is primary, made before the frame starts, so
/// the queue is filled once and drained. What `whitted` costs beyond it is its secondary rays.
class Diffuse final : public SurfaceShader {
 public:
  Diffuse(const Scene& scene, FrameBuffer& frame, const ShaderOptions& /*options*/)
      : SurfaceShader(scene, frame) {}

  static std::uint64_t rays_per_hit(const Scene& /*scene*/) { return 0; }
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override { return 1; }

  void on_hits(const Task& task, const Hits& hits, TaskSink& /*tasks*/) const override {
    for_each_hit(task, hits, Whitted::background, [&](std::uint32_t lane, const Surface& surface) {
      Vec3 light{Whitted::ambient, Whitted::ambient, Whitted::ambient};
      for (const PointLight& lamp : scene_.lights) {
        const Vec3 to_light = lamp.position - surface.point;
        const float cosine = dot(surface.normal, to_light) / length(to_light);
        if (cosine > 0) light = light + lamp.intensity * cosine;
      }
      return material_of(hits.triangle[lane]).diffuse * light;
    });
  }
};

}  // namespace irt
