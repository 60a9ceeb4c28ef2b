/// Every structure gives the bits of brute force, on ordinary meshes.
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

TEST(Agreement, SparseSoup) {
  const Mesh mesh = soup(2000, 0.05f);
  const Rays rays = random_rays(mesh, 4000);
  const std::uint32_t hits = expect_all_agree(mesh, rays);
  EXPECT_GT(hits, 400u);
  EXPECT_LT(hits, 4000u);
}

TEST(Agreement, DenseOverlappingSoup) {
  const Mesh mesh = soup(1000, 1.0f);
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 4000)), 800u);
}

TEST(Agreement, ClosedSphere) {
  const Mesh mesh = sphere(24, 32);
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 4000)), 1000u);
}

TEST(Agreement, AnyScale) {
  for (const float scale : {1e-10f, 1e-3f, 1e4f, 1e10f}) {
    SCOPED_TRACE(scale);
    const Mesh mesh = sphere(16, 24, scale);
    const std::uint32_t unit = expect_all_agree(sphere(16, 24), random_rays(sphere(16, 24), 2000));
    // Where the rays are the same up to scale, so are the hits, up to rounding at the rim.
    EXPECT_NEAR(expect_all_agree(mesh, random_rays(mesh, 2000)), unit, 20);
  }
}

/// Rays from inside and outside through the vertices and the edges' middles of a sphere.
Rays rays_through_seams(const Mesh& mesh, std::uint32_t count) {
  Random random(3);
  Rays rays(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t triangle = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const Vec3 a = mesh.corner(triangle, 0), b = mesh.corner(triangle, 1);
    const Vec3 target = i % 2 == 0 ? a : (a + b) * 0.5f;
    const Vec3 origin = i % 4 < 2 ? Vec3{} : target * 3.0f;
    rays.add({origin, target - origin}, {1, 1, 1}, i);
  }
  return rays;
}

TEST(Agreement, EveryKernel) {
  const Mesh ball = sphere(20, 24), tangle = soup(1000, 0.2f);
  const Rays seams = rays_through_seams(ball, 4000), rays = random_rays(tangle, 3000);
  for (const TriangleKernelEntry& entry : triangle_kernels()) {
    SCOPED_TRACE(entry.name);
    const std::uint32_t met = expect_all_agree(ball, seams, entry.kernel);
    // Others leak where rounding puts a vertex outside of all its triangles.
    EXPECT_GE(met, entry.kernel == TriangleKernel::watertight ? 4000u : 3500u);
    EXPECT_GT(expect_all_agree(tangle, rays, entry.kernel), 300u);
  }
}

TEST(Agreement, OptionsAreRefusedByName) {
  const Mesh mesh = soup(10, 0.5f);
  for (const char* const name : {"none", "goncalves"}) {
    EXPECT_THROW(build(name, mesh, {.width = 8}), std::invalid_argument);
    EXPECT_THROW(build(name, mesh, {.isa = "avx2"}), std::invalid_argument);
    EXPECT_NO_THROW(build(name, mesh, {.width = 1}));
  }
  for (const char* const name : {"wald", "wide"}) {
    EXPECT_THROW(build(name, mesh, {.width = 5}), std::invalid_argument);
    EXPECT_THROW(build(name, mesh, {.width = 4, .isa = "mmx"}), std::invalid_argument);
  }
  EXPECT_THROW(build("wald", mesh, {.isa = "avx2"}), std::invalid_argument);
}

/// A grid of axis-aligned quads, so that boxes are flat and rays run in their planes.
TEST(Agreement, RaysInPlanes) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 5; ++k) {
      Vec3 corner[4];
      for (int i = 0; i < 4; ++i) {
        corner[i][axis] = static_cast<float>(k);
        corner[i][(axis + 1) % 3] = i % 2 == 0 ? 0.0f : 4.0f;
        corner[i][(axis + 2) % 3] = i < 2 ? 0.0f : 4.0f;
      }
      add_triangle(mesh, corner[0], corner[1], corner[2]);
      add_triangle(mesh, corner[3], corner[1], corner[2]);
    }
  }
  Rays rays(3 * 2 * 2 * 100 + 2000);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float zero : {0.0f, -0.0f}) {
      for (const float sign : {1.0f, -1.0f}) {
        for (int i = 0; i < 100; ++i) {
          const int row = i / 10;
          Ray ray{{}, {zero, zero, zero}};
          ray.direction[axis] = sign;
          ray.origin[axis] = sign < 0 ? 5.0f : -1.0f;
          ray.origin[(axis + 1) % 3] = 0.5f * static_cast<float>(row);
          ray.origin[(axis + 2) % 3] = 0.5f * static_cast<float>(i % 10);
          rays.add(ray, {1, 1, 1}, 0);
        }
      }
    }
  }
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    Ray ray{random.in_box({-1, -1, -1}, {5, 5, 5}), random.in_box({-1, -1, -1}, {1, 1, 1})};
    const int axis = i % 3;
    ray.origin[axis] = static_cast<float>(random.below(5));
    ray.direction[axis] = 0;
    rays.add(ray, {1, 1, 1}, 0);
  }
  const Expected expected = brute_force(mesh, rays);
  // 81 of the 100 rays of each axis-parallel bundle end on the faces 0..4, rims included.
  for (std::uint32_t bundle = 0; bundle < 12; ++bundle) {
    std::uint32_t met = 0;
    for (std::uint32_t i = 0; i < 100; ++i) {
      met += expected.hits.triangle[bundle * 100 + i] != no_triangle;
    }
    EXPECT_EQ(met, 81u) << "bundle " << bundle;
  }
  EXPECT_GT(expect_all_agree(mesh, rays), 2000u);
}

TEST(Agreement, EmptyBatchAndEmptyMesh) {
  const Mesh none;
  const Mesh mesh = soup(10, 0.5f);
  EXPECT_EQ(expect_all_agree(mesh, Rays(0)), 0u);
  EXPECT_EQ(expect_all_agree(mesh, Rays(16)), 0u);
  EXPECT_EQ(expect_all_agree(none, random_rays(mesh, 40)), 0u);
}

TEST(Agreement, ProfileAddsTimeAndChangesNothing) {
  const Mesh mesh = soup(2000, 0.1f);
  const Rays rays = random_rays(mesh, 2000);
  for (const AcceleratorEntry& entry : accelerators()) {
    SCOPED_TRACE(entry.name);
    const auto accelerator = entry.build(mesh, {});
    Hits plain(rays.size), profiled(rays.size);
    std::vector<std::uint8_t> occluded(rays.size);
    TraceProfile profile;
    accelerator->closest_hit(rays, plain);
    accelerator->closest_hit(rays, profiled, &profile);
    const TraceProfile once = profile;
    accelerator->any_hit(rays, occluded, &profile);
    EXPECT_GT(once.intersect_ns, 0u);
    EXPECT_GT(profile.intersect_ns, once.intersect_ns);
    EXPECT_TRUE(entry.name == "none" || once.traverse_ns > 0);
    for (std::uint32_t i = 0; i < rays.size; ++i) {
      ASSERT_EQ(plain.triangle[i], profiled.triangle[i]);
    }
  }
}

}  // namespace
}  // namespace irt::test
