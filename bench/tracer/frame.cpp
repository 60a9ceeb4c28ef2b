#include "bench/tracer/frame.hpp"

#include "bench/tracer/scene_rays.hpp"
#include "renderer/tracing/stopwatch.hpp"
#include "renderer/tracing/surface.hpp"

namespace irt::bench {
namespace {

/// What one task needs, kept from task to task.
struct Scratch {
  Rays primary{tile_rays}, secondary{tile_rays};
  Hits hits{tile_rays}, further{tile_rays};
  LaneArray<std::uint8_t> occluded{tile_rays};
};

void trace_tile(const Scene& scene, std::uint32_t side, std::uint32_t tile,
                const Contestant& contestant, Scratch& scratch, std::vector<float>& image) {
  const std::uint32_t across = (side + tile_side - 1) / tile_side;
  Rays& primary = scratch.primary;
  primary.size = 0;
  add_tile(scene.camera, side, tile % across * tile_side, tile / across * tile_side, primary);
  contestant.closest_hit(primary, scratch.hits);

  Rays& secondary = scratch.secondary;
  for (std::size_t light = 0; light < scene.lights.size(); ++light) {
    secondary.size = 0;
    add_shadow_rays(scene, light, primary, scratch.hits, secondary);
    contestant.any_hit(secondary, {scratch.occluded.data(), secondary.size});
    for (std::uint32_t lane = 0; lane < secondary.size; ++lane) {
      if (scratch.occluded[lane] == 0) {
        image[secondary.pixel[lane]] += 0.2f * secondary.weight_g[lane];
      }
    }
  }

  secondary.size = 0;
  add_mirrored_rays(scene, primary, scratch.hits, secondary);
  contestant.closest_hit(secondary, scratch.further);
  for (std::uint32_t lane = 0; lane < secondary.size; ++lane) {
    if (scratch.further.triangle[lane] == no_triangle) continue;
    const Ray ray = secondary.ray(lane);
    const auto surface =
        surface_at(scene.mesh, scratch.further.triangle[lane], scratch.further.u[lane],
                   scratch.further.v[lane], ray.direction);
    if (!surface) continue;
    for (const PointLight& light : scene.lights) {
      const Vec3 to_light = light.position - surface->point;
      const float cosine = dot(surface->normal, to_light) / length(to_light);
      if (cosine > 0) image[secondary.pixel[lane]] += 0.05f * cosine;
    }
  }
}

}  // namespace

std::vector<float> trace_frame(const Scene& scene, std::uint32_t side, const Contestant& contestant,
                               Executor& executor, TaskTimes* times) {
  std::vector<float> image(std::size_t{side} * side);
  const std::uint32_t across = (side + tile_side - 1) / tile_side;
  const std::size_t tiles = std::size_t{across} * across;
  std::span<std::uint64_t> ticks;
  if (times != nullptr) ticks = times->add_round(tiles);
  executor.for_each(tiles, [&](std::size_t tile) {
    thread_local Scratch scratch;
    const std::uint64_t start = ticks_now();
    trace_tile(scene, side, static_cast<std::uint32_t>(tile), contestant, scratch, image);
    if (times != nullptr) ticks[tile] = ticks_now() - start;
  });
  return image;
}

}  // namespace irt::bench
