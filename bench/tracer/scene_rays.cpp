#include "bench/tracer/scene_rays.hpp"

#include "renderer/shading/primary_rays.hpp"
#include "renderer/tracing/surface.hpp"

namespace irt::tracer {
namespace {

constexpr std::uint32_t even_bits(std::uint32_t morton) {
  return (morton & 1u) | (morton >> 1 & 2u) | (morton >> 2 & 4u) | (morton >> 3 & 8u);
}

template <class Use>
void for_each_surface(const Scene& scene, const Rays& rays, const Hits& hits, const Use& use) {
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    if (hits.triangle[lane] == no_triangle) continue;
    const Ray ray = rays.ray(lane);
    const auto surface =
        surface_at(scene.mesh, hits.triangle[lane], hits.u[lane], hits.v[lane], ray.direction);
    if (surface) use(lane, ray, *surface);
  }
}

}  // namespace

std::string_view name_of(RayKind kind) {
  return kind == RayKind::primary ? "primary" : kind == RayKind::shadow ? "shadow" : "specular";
}

void add_tile(const Camera& camera, std::uint32_t side, std::uint32_t left, std::uint32_t top,
              Rays& rays) {
  const PrimaryRays primary(camera, side, side);
  for (std::uint32_t morton = 0; morton < tile_rays; ++morton) {
    const std::uint32_t x = left + even_bits(morton), y = top + even_bits(morton >> 1);
    if (x < side && y < side) rays.add(primary.through(x, y), {1, 1, 1}, y * side + x);
  }
}

void add_shadow_rays(const Scene& scene, std::size_t light, const Rays& rays, const Hits& hits,
                     Rays& shadow) {
  const Vec3 from = scene.lights[light].position;
  for_each_surface(scene, rays, hits, [&](std::uint32_t lane, const Ray&, const Surface& surface) {
    const Vec3 to_light = from - surface.point;
    // Towards the side of the light, so that a light behind the surface is hidden by the scene and
    // not by the surface itself.
    Surface facing = surface;
    if (dot(facing.normal, to_light) < 0) facing.normal = -facing.normal;
    const Vec3 weight = scene.lights[light].intensity *
                        (std::max(0.0f, dot(surface.normal, to_light)) / length(to_light));
    shadow.add({from, facing.lifted(from) - from, 1}, weight, rays.pixel[lane]);
  });
}

void add_mirrored_rays(const Scene& scene, const Rays& rays, const Hits& hits, Rays& mirrored) {
  for_each_surface(scene, rays, hits, [&](std::uint32_t lane, const Ray& ray, const Surface& at) {
    mirrored.add({at.lifted(ray.origin), reflect(ray.direction, at.normal)}, {1, 1, 1},
                 rays.pixel[lane]);
  });
}

std::vector<Rays> rays_of(const Scene& scene, std::uint32_t side, RayKind kind,
                          const Contestant& guide) {
  std::vector<Rays> batches;
  Hits hits(tile_rays);
  for (std::uint32_t top = 0; top < side; top += tile_side) {
    for (std::uint32_t left = 0; left < side; left += tile_side) {
      Rays primary(tile_rays);
      add_tile(scene.camera, side, left, top, primary);
      if (kind == RayKind::primary) {
        batches.push_back(std::move(primary));
        continue;
      }
      guide.accelerator->closest_hit(primary, hits);
      for (std::size_t i = 0; i < (kind == RayKind::shadow ? scene.lights.size() : 1); ++i) {
        Rays next(tile_rays);
        if (kind == RayKind::shadow) {
          add_shadow_rays(scene, i, primary, hits, next);
        } else {
          add_mirrored_rays(scene, primary, hits, next);
        }
        if (next.size > 0) batches.push_back(std::move(next));
      }
    }
  }
  return batches;
}

}  // namespace irt::tracer
