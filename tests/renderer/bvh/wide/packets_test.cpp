/// Packets of every width with every kernel on every instruction set: the bits of brute force.
#include <gtest/gtest.h>

#include "renderer/bvh/executor.hpp"
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

/// From `eye` through a square of `side` x `side` pixels around `target`, 4 x 4 at a time.
Rays pinhole(Vec3 eye, Vec3 target, float opening, std::uint32_t side) {
  const Vec3 ahead = target - eye;
  const Vec3 up = std::abs(ahead.y) < 0.9f * length(ahead) ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  const Vec3 right = normalize(cross(ahead, up)) * (opening * length(ahead));
  const Vec3 above = normalize(cross(right, ahead)) * (opening * length(ahead));
  Rays rays(side * side);
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const std::uint32_t tile = i / 16, in = i % 16, across = side / 4;
    const std::uint32_t column = tile % across * 4 + in % 4, row = tile / across * 4 + in / 4;
    const auto x = static_cast<float>(column) / static_cast<float>(side);
    const auto y = static_cast<float>(row) / static_cast<float>(side);
    rays.add({eye, ahead + right * (x - 0.5f) + above * (y - 0.5f)}, {1, 1, 1}, i);
  }
  return rays;
}

TEST(WidePackets, IncoherentRays) {
  const Mesh mesh = soup(1500, 0.2f);
  EXPECT_GT(expect_every_way_agrees("wide", mesh, random_rays(mesh, 1500)), 300u);
}

TEST(WidePackets, PinholeRays) {
  const Mesh mesh = soup(3000, 0.1f);
  const Vec3 eye{0.5f, 0.5f, -2};
  EXPECT_GT(expect_every_way_agrees("wide", mesh, pinhole(eye, {0.4f, 0.6f, 0.5f}, 0.4f, 32)),
            500u);
}

/// Directions of all signs in one packet, and zeros.
TEST(WidePackets, PinholeRaysAlongAnAxis) {
  const Mesh mesh = sphere(24, 32);
  EXPECT_GT(expect_every_way_agrees("wide", mesh, pinhole({0, 0, -3}, {0, 0, 0}, 0.8f, 32)), 300u);
  EXPECT_EQ(expect_every_way_agrees("wide", mesh, pinhole({0, 0, 0}, {0, 1, 0}, 3.0f, 16)), 256u);
}

/// As shadow rays: from a light to points on the mesh, where the ray ends or just before.
TEST(WidePackets, RaysThatEndOnTheMesh) {
  const Mesh mesh = soup(2000, 0.15f);
  const Rays rays = pinhole({0.5f, 2, 0.4f}, {0.5f, 0.5f, 0.5f}, 0.5f, 32);
  const Expected first = brute_force(mesh, rays);
  Rays shadow(rays.size);
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    Ray ray = rays.ray(i);
    if (first.hits.triangle[i] == no_triangle) continue;
    // Exactly there it is not met any more; a little further it is.
    ray.t_max = first.hits.t[i] * (i % 3 == 0 ? 1.0f : i % 3 == 1 ? 1.001f : 0.999f);
    shadow.add(ray, {1, 1, 1}, 0);
  }
  const std::uint32_t hits = expect_every_way_agrees("wide", mesh, shadow);
  EXPECT_GT(hits, shadow.size / 4);
  EXPECT_LT(hits, shadow.size / 2);
}

TEST(WidePackets, BatchesOfAnySize) {
  const Mesh mesh = soup(300, 0.4f);
  for (const std::uint32_t count : {1u, 3u, 4u, 15u, 16u, 17u, 63u, 255u, 257u}) {
    SCOPED_TRACE(count);
    expect_every_way_agrees("wide", mesh, random_rays(mesh, count, count));
  }
}

TEST(WidePackets, GarbageAmongSoundRays) {
  const Mesh mesh = sphere(12, 16);
  Rays rays = pinhole({0.1f, 0.2f, -3}, {0, 0, 0}, 0.3f, 16);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), inf, -inf};
  for (std::uint32_t i = 0; i < rays.size; i += 5) {
    LaneArray<float>* const arrays[] = {&rays.origin_x, &rays.origin_z, &rays.direction_y,
                                        &rays.direction_x};
    (*arrays[i % 4])[i] = bad[i % 3];
  }
  for (std::uint32_t i = 1; i < rays.size; i += 7) rays.t_max[i] = i % 2 == 0 ? 0.0f : -1.0f;
  for (std::uint32_t i = 2; i < rays.size; i += 7) rays.t_max[i] = bad[0];
  EXPECT_GT(expect_every_way_agrees("wide", mesh, rays), 100u);
}

TEST(WidePackets, CoincidentTrianglesGiveTheLowestIndex) {
  Mesh mesh;
  for (int i = 0; i < 500; ++i) add_triangle(mesh, {-1, -1, 0}, {3, -1, 0}, {-1, 3, 0});
  const Rays rays = pinhole({0.3f, 0.3f, -2}, {0.3f, 0.3f, 0}, 0.3f, 16);
  EXPECT_EQ(expect_every_way_agrees("wide", mesh, rays), 256u);
}

TEST(WidePackets, AnyScale) {
  for (const float scale : {1e-10f, 1e-3f, 1e10f}) {
    SCOPED_TRACE(scale);
    const Mesh mesh = sphere(12, 16, scale);
    const Vec3 eye{0.5f * scale, 0.4f * scale, -3 * scale};
    EXPECT_GT(expect_every_way_agrees("wide", mesh, pinhole(eye, {}, 0.5f, 16)), 100u);
  }
}

TEST(WidePackets, OneTriangle) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_GT(expect_every_way_agrees("wide", mesh, pinhole({0.2f, 0.2f, 1}, {0.3f, 0.3f, 0}, 2, 16)),
            20u);
}

}  // namespace
}  // namespace irt::test
