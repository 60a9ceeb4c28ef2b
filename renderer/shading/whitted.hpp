/// The thesis' shader (chapter 4): one shadow ray per light and hit, one specular ray where the
/// material reflects (Whitted 1980), without recursion.
#pragma once

#include <vector>

#include "renderer/shading/shader.hpp"
#include "renderer/tracing/surface.hpp"

namespace irt {

/// A ray carries its weight: the product of the BRDFs and cosines on its path. A shadow ray carries
/// the light as well, so that an unoccluded one simply adds its weight to the pixel.
///
/// Shadow rays start at the light and end just above the surface, and the rays of a task are bound
/// for one light: they share their origin, which keeps them coherent.
///
/// No ray is spent where it cannot bring light: none from a light behind the surface, none to a
/// material that is black to it.
class Whitted final : public Shader {
 public:
  /// Keeps the parts of a scene that no light reaches readable.
  static constexpr float ambient = 0.1f;
  static constexpr Vec3 background{0.08f, 0.1f, 0.14f};

  Whitted(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options)
      : scene_(scene), frame_(frame), max_depth_(options.max_depth) {}

  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const override {
    std::vector<Task*> shadow(scene_.lights.size());
    Task* specular = nullptr;
    for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
      const Vec3 weight = task.rays.weight(lane);
      const std::uint32_t pixel = task.rays.pixel[lane];
      const std::uint32_t triangle = hits.triangle[lane];
      if (triangle == no_triangle) {
        frame_.add(pixel, weight * background);
        continue;
      }
      const Ray ray = task.rays.ray(lane);
      const auto surface =
          surface_at(scene_.mesh, triangle, hits.u[lane], hits.v[lane], ray.direction);
      if (!surface) {
        frame_.add(pixel, {});
        continue;
      }
      const Material& material = scene_.materials[scene_.mesh.material[triangle]];
      const Vec3 matt = weight * material.diffuse;
      frame_.add(pixel, matt * ambient);

      for (std::size_t i = 0; i < shadow.size(); ++i) {
        const PointLight& light = scene_.lights[i];
        const Vec3 to_light = light.position - surface->point;
        const float cosine = dot(surface->normal, to_light) / length(to_light);
        const Vec3 brings = matt * light.intensity * cosine;
        if (!(cosine > 0) || black(brings)) continue;  // NaN: the light lies on the surface
        if (shadow[i] == nullptr) shadow[i] = &tasks.add(TaskKind::shadow, task.depth);
        const Vec3 end = surface->lifted(light.position);
        shadow[i]->rays.add({light.position, end - light.position, 1}, brings, pixel);
      }

      const Vec3 mirrored = weight * material.specular;
      if (task.depth == max_depth_ || black(mirrored)) continue;
      if (specular == nullptr) specular = &tasks.add(TaskKind::specular, task.depth + 1);
      specular->rays.add({surface->lifted(ray.origin), reflect(ray.direction, surface->normal)},
                         mirrored, pixel);
    }
  }

  void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                    TaskSink& /*tasks*/) const override {
    for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
      frame_.add(task.rays.pixel[lane], occluded[lane] != 0 ? Vec3{} : task.rays.weight(lane));
    }
  }

  /// A path has at most `max_depth` + 1 hits, each with one ray that led there and its shadow rays.
  std::uint64_t max_rays_per_sample() const override {
    return (std::uint64_t{max_depth_} + 1) * rays_per_hit(scene_);
  }
  static std::uint64_t rays_per_hit(const Scene& scene) { return scene.lights.size() + 1; }

 private:
  static bool black(Vec3 colour) { return !(colour.x > 0 || colour.y > 0 || colour.z > 0); }

  const Scene& scene_;
  FrameBuffer& frame_;
  std::uint32_t max_depth_;
};

}  // namespace irt
