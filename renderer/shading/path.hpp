/// A small path tracer.
#pragma once

#include <algorithm>
#include <vector>

#include "renderer/shading/random.hpp"
#include "renderer/shading/surface_shader.hpp"
#include "renderer/shading/whitted.hpp"

namespace irt {

/// Light that has been reflected any number of times, up to the depth limit (Kajiya 1986, "The
/// rendering equation"). Every hit asks one light, drawn at random, with a shadow ray, and goes on
/// with one ray: mirrored or scattered, drawn by what the material reflects. What leaves the scene
/// meets a sky as bright as the background of `whitted`.
///
/// Noisy with one sample per pixel; 64 and more give a picture. As a workload it has the least
/// coherent rays there are, in tasks that get smaller with every bounce.
class PathTracer final : public SurfaceShader {
 public:
  PathTracer(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options)
      : SurfaceShader(scene, frame), max_depth_(options.max_depth) {}

  static std::uint64_t rays_per_hit(const Scene& /*scene*/) { return 2; }
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override {
    return 2 * (std::uint64_t{max_depth_} + 1);
  }

  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const override {
    std::vector<Task*> shadow(scene_.lights.size());
    Task* onwards = nullptr;
    for_each_hit(task, hits, Whitted::background, [&](std::uint32_t lane, const Surface& surface) {
      RayRandom random(task.rays.pixel[lane], task.sample, task.depth);
      const Material& material = material_of(hits.triangle[lane]);
      const Vec3 weight = task.rays.weight(lane);
      ask_light(task, lane, surface, weight * material.diffuse, random, shadow, tasks);
      if (task.depth == max_depth_) return Vec3{};

      const float scatters = sum(material.diffuse), mirrors = sum(material.specular);
      if (!(scatters + mirrors > 0)) return Vec3{};
      if (onwards == nullptr) {
        onwards = &tasks.add(TaskKind::specular, task.depth + 1, task.sample);
      }
      const float share = mirrors / (scatters + mirrors);
      const Ray ray = task.rays.ray(lane);
      if (random.uniform() < share) {
        onwards->rays.add({surface.lifted(ray.origin), reflect(ray.direction, surface.normal)},
                          weight * material.specular * (1 / share), task.rays.pixel[lane]);
      } else {
        onwards->rays.add({surface.lifted(surface.point), random.cosine_weighted(surface.normal)},
                          weight * material.diffuse * (1 / (1 - share)), task.rays.pixel[lane]);
      }
      return Vec3{};
    });
  }

 private:
  static float sum(Vec3 colour) { return colour.x + colour.y + colour.z; }

  /// A shadow ray to one light, which stands for all of them.
  void ask_light(const Task& task, std::uint32_t lane, const Surface& surface, Vec3 matt,
                 RayRandom& random, std::vector<Task*>& shadow, TaskSink& tasks) const {
    const auto lights = static_cast<std::uint32_t>(scene_.lights.size());
    if (lights == 0) return;
    const std::uint32_t chosen = random.below(lights);
    const PointLight& light = scene_.lights[chosen];
    const Vec3 to_light = light.position - surface.point;
    const float cosine = dot(surface.normal, to_light) / length(to_light);
    const Vec3 brings = matt * light.intensity * (cosine * static_cast<float>(lights));
    if (!(cosine > 0) || black(brings)) return;
    if (shadow[chosen] == nullptr) {
      shadow[chosen] = &tasks.add(TaskKind::shadow, task.depth, task.sample);
    }
    const Vec3 end = surface.lifted(light.position);
    shadow[chosen]->rays.add({light.position, end - light.position, 1}, brings,
                             task.rays.pixel[lane]);
  }

  std::uint32_t max_depth_;
};

}  // namespace irt
