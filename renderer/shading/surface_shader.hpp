/// What shaders that look at one hit after the other share.
#pragma once

#include "renderer/shading/shader.hpp"
#include "renderer/tracing/surface.hpp"

namespace irt {

/// Walks over the hits of a task, and lets unoccluded rays bring what they weigh.
class SurfaceShader : public Shader {
 public:
  SurfaceShader(const Scene& scene, FrameBuffer& frame) : scene_(scene), frame_(frame) {}

  void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                    TaskSink& /*tasks*/) const override {
    for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
      frame_.add(task.rays.pixel[lane], occluded[lane] != 0 ? Vec3{} : task.rays.weight(lane));
    }
  }

 protected:
  /// Calls `shade(lane, surface)` for every ray that has met a surface; it returns the ray's
  /// contribution before its weight. A ray that has met nothing contributes `background`.
  template <class Shade>
  void for_each_hit(const Task& task, const Hits& hits, Vec3 background, Shade shade) const {
    for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
      Vec3 light = background;
      if (hits.triangle[lane] != no_triangle) {
        const auto surface = surface_at(scene_.mesh, hits.triangle[lane], hits.u[lane],
                                        hits.v[lane], task.rays.ray(lane).direction);
        light = surface ? shade(lane, *surface) : Vec3{};
      }
      frame_.add(task.rays.pixel[lane], task.rays.weight(lane) * light);
    }
  }

  [[nodiscard]] const Material& material_of(std::uint32_t triangle) const {
    return scene_.materials[scene_.mesh.material[triangle]];
  }

  static bool black(Vec3 colour) { return !(colour.x > 0 || colour.y > 0 || colour.z > 0); }

  const Scene& scene_;
  FrameBuffer& frame_;
};

}  // namespace irt
