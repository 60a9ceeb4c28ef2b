/// Closed meshes and rays at their seams: none may pass.
#pragma once

#include <cmath>
#include <gtest/gtest.h>

#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {

/// A closed lumpy ball around `centre` that a ray from near the centre cannot leave unseen.
inline Mesh potato(Vec3 centre, float scale, std::uint32_t rings, std::uint32_t segments) {
  Mesh mesh = sphere(rings, segments);
  for (Vec3& vertex : mesh.vertices) {
    const float lump = 1 + 0.2f * std::sin(5 * vertex.x) * std::cos(7 * vertex.y + vertex.z);
    vertex = centre + vertex * (lump * scale);
  }
  return mesh;
}

/// Traces `count` rays through vertices, edges and points beside edges, from within and from
/// outside towards the centre, and returns how many met nothing.
inline std::uint32_t leaks(const Accelerator& accelerator, const Mesh& mesh, Vec3 centre,
                           float scale, std::uint32_t count, std::uint32_t seed) {
  Random random(seed);
  constexpr std::uint32_t batch = 1000;
  Hits hits(batch);
  std::uint32_t leaked = 0;
  for (std::uint32_t done = 0; done < count; done += batch) {
    Rays rays(batch);
    for (std::uint32_t i = 0; i < batch; ++i) {
      const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
      const std::uint32_t triangle = random.below(triangles);
      const Vec3 a = mesh.corner(triangle, 0), b = mesh.corner(triangle, 1);
      Vec3 target = i % 3 == 0 ? a : a + (b - a) * random.uniform(0, 1);
      if (i % 3 == 2) target[static_cast<int>(random.below(3))] *= 1 + 0x1p-23f;
      const float spread = 0.05f * scale;
      const Vec3 within =
          centre + random.in_box({-spread, -spread, -spread}, {spread, spread, spread});
      const bool outside = i % 2 == 1;
      const Vec3 origin = outside ? within + (target - within) * random.uniform(1.5f, 30) : within;
      rays.add({origin, outside ? within - origin : target - origin}, {1, 1, 1}, i);
    }
    accelerator.closest_hit(rays, hits);
    for (std::uint32_t i = 0; i < batch; ++i) leaked += hits.triangle[i] == no_triangle;
  }
  return leaked;
}

struct WatertightCase {
  Vec3 centre;
  float scale;
};
/// Around the origin and away from it, in metres and millimetres.
inline constexpr WatertightCase watertight_cases[]{
    {{0, 0, 0}, 1}, {{0, 0, 0}, 1e-3f}, {{10, -20, 30}, 1}, {{1e3f, 1e3f, -1e3f}, 100}};

/// Every structure that takes the watertight kernel, `count` rays over all cases each.
inline void expect_no_leak(std::uint32_t count, std::uint32_t rings, std::uint32_t segments) {
  int tried = 0;
  for (const std::string& name : structure_names()) {
    for (const auto& [centre, scale] : watertight_cases) {
      SCOPED_TRACE(::testing::Message() << name << ", scale " << scale << ", x " << centre.x);
      const Mesh mesh = potato(centre, scale, rings, segments);
      std::unique_ptr<Accelerator> accelerator;
      try {
        accelerator = build(name, mesh, {.kernel = TriangleKernel::watertight});
      } catch (const std::invalid_argument&) {
        continue;
      }
      ++tried;
      const auto rays = count / static_cast<std::uint32_t>(std::size(watertight_cases));
      EXPECT_EQ(leaks(*accelerator, mesh, centre, scale, rays, 5), 0u);
    }
  }
  EXPECT_GE(tried, 2);
}

}  // namespace irt::test
