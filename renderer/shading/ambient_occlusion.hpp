/// How much of the sky each point would see if only its neighbourhood stood in the way.
#pragma once

#include "renderer/shading/random.hpp"
#include "renderer/shading/surface_shader.hpp"

namespace irt {

/// Eight short rays per hit, spread by the cosine (Zhukov, Iones and Kronin 1998, "An ambient light
/// illumination model"). More `--samples-per-pixel` take the noise out.
///
/// A workload of its own kind: nothing but shadow rays, and no two of a task alike in direction.
class AmbientOcclusion final : public SurfaceShader {
 public:
  static constexpr std::uint32_t rays = 8;
  /// Of the scene's diagonal: what is further away does not darken.
  static constexpr float reach = 0.1f;

  AmbientOcclusion(const Scene& scene, FrameBuffer& frame, const ShaderOptions& /*options*/)
      : SurfaceShader(scene, frame) {
    Vec3 low = scene.mesh.vertices.front(), high = low;
    for (const Vec3 vertex : scene.mesh.vertices) {
      low = min(low, vertex);
      high = max(high, vertex);
    }
    distance_ = reach * length(high - low);
  }

  static std::uint64_t rays_per_hit(const Scene& /*scene*/) { return rays; }
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override { return 1 + rays; }

  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const override {
    Task* occlusion[rays] = {};
    for_each_hit(task, hits, {1, 1, 1}, [&](std::uint32_t lane, const Surface& surface) {
      RayRandom random(task.rays.pixel[lane], task.sample, task.depth);
      const Vec3 origin = surface.lifted(surface.point);
      for (Task*& further : occlusion) {
        if (further == nullptr) further = &tasks.add(TaskKind::shadow, task.depth, task.sample);
        further->rays.add({origin, random.cosine_weighted(surface.normal), distance_},
                          task.rays.weight(lane) * (1.0f / rays), task.rays.pixel[lane]);
      }
      return Vec3{};
    });
  }

 private:
  float distance_;
};

}  // namespace irt
