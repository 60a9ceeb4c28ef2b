/// An accelerator of a few lines, so that tests of the engine stand on nothing else.
#pragma once

#include "renderer/bvh/accelerator.hpp"

namespace irt {

/// Tests every triangle (Möller and Trumbore 1997).
class BruteForce final : public Accelerator {
 public:
  explicit BruteForce(const Mesh& mesh) : mesh_(mesh) {}

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const override {
    for (std::uint32_t i = 0; i < rays.size; ++i) {
      const Hit hit = trace(rays.ray(i));
      hits.t[i] = hit.t;
      hits.u[i] = hit.u;
      hits.v[i] = hit.v;
      hits.triangle[i] = hit.triangle;
    }
    if (profile != nullptr) profile->intersect_ns += rays.size;
  }

  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile) const override {
    for (std::uint32_t i = 0; i < rays.size; ++i) {
      occluded[i] = trace(rays.ray(i)).triangle != no_triangle;
    }
    if (profile != nullptr) profile->intersect_ns += rays.size;
  }

  [[nodiscard]] std::size_t memory_bytes() const override { return 0; }

  [[nodiscard]] Hit trace(const Ray& ray) const {
    Hit first;
    first.t = ray.t_max;
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Vec3 a = mesh_.corner(i, 0);
      const Vec3 ab = mesh_.corner(i, 1) - a, ac = mesh_.corner(i, 2) - a;
      const Vec3 p = cross(ray.direction, ac);
      const float determinant = dot(ab, p);
      if (determinant == 0) continue;
      const float scale = 1 / determinant;
      const Vec3 from = ray.origin - a;
      const float u = dot(from, p) * scale;
      const Vec3 q = cross(from, ab);
      const float v = dot(ray.direction, q) * scale;
      const float t = dot(ac, q) * scale;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < first.t) first = {t, u, v, i};
    }
    return first;
  }

 private:
  const Mesh& mesh_;
};

}  // namespace irt
