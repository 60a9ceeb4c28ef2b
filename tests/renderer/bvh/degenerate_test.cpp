/// Meshes and rays that have broken hierarchies before: frozen bad inputs.
#include <cfloat>
#include <cmath>

#include "tests/renderer/bvh/agreement.hpp"
#include "tests/renderer/bvh/watertight.hpp"

namespace irt::test {
namespace {

TEST(Degenerate, CoincidentTrianglesGiveTheLowestIndex) {
  Mesh mesh;
  for (int i = 0; i < 5000; ++i) add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  Rays rays(2);
  rays.add({{0.25f, 0.25f, 1}, {0, 0, -1}}, {1, 1, 1}, 0);
  rays.add({{0.25f, 0.25f, -1}, {0, 0, 1}}, {1, 1, 1}, 0);
  EXPECT_EQ(brute_force(mesh, rays).hits.triangle[0], 0u);
  EXPECT_EQ(expect_all_agree(mesh, rays), 2u);
}

TEST(Degenerate, DuplicatesScatteredOverTheMesh) {
  Mesh mesh = soup(1000, 0.3f);
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    // Every copy starts at another corner or turns the other way round.
    const std::uint32_t of = random.below(1000);
    add_triangle(mesh, mesh.corner(of, i % 3), mesh.corner(of, (i + (i & 1 ? 1 : 2)) % 3),
                 mesh.corner(of, (i + (i & 1 ? 2 : 1)) % 3));
  }
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 3000)), 500u);
}

TEST(Degenerate, OneTriangle) {
  const Mesh mesh = soup(1, 1.0f);
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 2000)), 10u);
}

TEST(Degenerate, PointsAndNeedlesAreNeverMet) {
  Mesh mesh;
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = random.in_box({0, 0, 0}, {1, 1, 1}), b = random.in_box({0, 0, 0}, {1, 1, 1});
    if (i % 3 == 0) add_triangle(mesh, a, a, a);
    if (i % 3 == 1) add_triangle(mesh, a, b, b);
    if (i % 3 == 2) add_triangle(mesh, a, b, a);
  }
  Rays rays = random_rays(mesh, 1000);
  EXPECT_EQ(expect_all_agree(mesh, rays), 0u);
}

TEST(Degenerate, AllOnOneLine) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i);
    add_triangle(mesh, {x, 0, 0}, {x + 1, 0, 0}, {x + 2, 0, 0});
  }
  EXPECT_EQ(expect_all_agree(mesh, random_rays(mesh, 1000)), 0u);
}

/// Each triangle is half as far as the one before: binning takes off one at a time.
TEST(Degenerate, ExponentialSpacing) {
  Mesh mesh;
  for (int i = 0; i < 200; ++i) {
    for (int copy = 0; copy < 20; ++copy) {
      const float x = std::ldexp(1.0f, i - 120);
      add_triangle(mesh, {x, 0, 0}, {x, x, 0}, {x, 0, x});
    }
  }
  Rays rays(400);
  for (int i = 0; i < 400; ++i) {
    const float x = std::ldexp(1.0f, i / 2 - 120);
    rays.add({{0, x * 0.25f, x * 0.25f}, {1, 0, i % 2 == 0 ? 0 : 0.01f}}, {1, 1, 1}, 0);
  }
  EXPECT_GT(expect_all_agree(mesh, rays), 100u);
}

TEST(Degenerate, HugeAndTinyCoordinatesTogether) {
  Mesh mesh = soup(300, 0.3f, 1e-12f);
  for (const float scale : {1.0f, 1e12f, 1e25f, 1e38f}) {
    const Mesh more = soup(300, 0.3f, scale);
    for (std::uint32_t i = 0; i < 300; ++i) {
      add_triangle(mesh, more.corner(i, 0), more.corner(i, 1), more.corner(i, 2));
    }
  }
  add_triangle(mesh, {-FLT_MAX, -FLT_MAX, 0}, {FLT_MAX, -FLT_MAX, 0}, {0, FLT_MAX, 0});
  add_triangle(mesh, {FLT_MIN, 0, 0}, {0, FLT_MIN, 0}, {0, 0, FLT_TRUE_MIN});
  for (const float scale : {1e-12f, 1.0f, 1e12f, 1e30f}) {
    expect_all_agree(mesh, random_rays(soup(50, 0.3f, scale), 1000));
  }
}

TEST(Degenerate, GarbageRaysMeetNothing) {
  const Mesh mesh = soup(500, 1.0f);
  const std::vector<Ray> garbage{
      {{nan, 0, 0}, {1, 1, 1}},
      {{0.5f, 0.5f, 0.5f}, {nan, 1, 0}},
      {{inf, 0, 0}, {-1, 0, 0}},
      {{-inf, 0.5f, 0.5f}, {1, 0, 0}},
      {{0.5f, 0.5f, 0.5f}, {inf, 0, 0}},
      {{0.5f, 0.5f, 0.5f}, {1, -inf, 0}},
      {{0.5f, 0.5f, 0.5f}, {0, 0, 0}},
      {{0.5f, 0.5f, -9}, {0, 0, 1}, nan},
      {{0.5f, 0.5f, -9}, {0, 0, 1}, -1},
      {{0.5f, 0.5f, -9}, {0, 0, 1}, 0},
      {{0.5f, 0.5f, -9}, {0, 0, 1}, -inf},
      {{0.5f, 0.5f, -9}, {0, 0, 1}, FLT_TRUE_MIN},
  };
  Rays rays(static_cast<std::uint32_t>(garbage.size()));
  for (const Ray& ray : garbage) rays.add(ray, {1, 1, 1}, 0);
  EXPECT_EQ(expect_all_agree(mesh, rays), 0u);
}

TEST(Degenerate, DirectionsOfAnyLength) {
  const Mesh mesh = sphere(12, 16);
  Rays rays(900);
  Random random(4);
  for (int i = 0; i < 900; ++i) {
    const Vec3 direction = random.in_box({-1, -1, -1}, {1, 1, 1});
    const float scale = std::ldexp(1.0f, (i % 9 - 4) * 10);
    rays.add({{}, direction * scale}, {1, 1, 1}, 0);
  }
  EXPECT_GT(expect_all_agree(mesh, rays), 850u);
}

TEST(Watertight, RaysAtSeamsPassNowhere) {
  expect_no_leak(100'000, 30, 40);
}

/// The same rays do find the seams: Möller and Trumbore let some through.
TEST(Watertight, OthersLeak) {
  const Mesh mesh = potato({10, -20, 30}, 1, 30, 40);
  EXPECT_GT(leaks(*build("goncalves", mesh), mesh, {10, -20, 30}, 1, 100'000, 5), 0u);
}

/// Many triangles that share one centre: sorting and binning tell none apart.
TEST(Degenerate, ConcentricTriangles) {
  Mesh mesh;
  for (int i = 1; i <= 3000; ++i) {
    const auto r = static_cast<float>(i);
    add_triangle(mesh, {-r, -r, 0}, {r, -r, 0}, {0, r, 0});
  }
  Random random(8);
  Rays rays(1000);
  for (int i = 0; i < 1000; ++i) {
    rays.add({random.in_box({-3000, -3000, 1}, {3000, 3000, 2}),
              random.in_box({-1, -1, -1}, {1, 1, -0.1f})},
             {1, 1, 1}, 0);
  }
  EXPECT_GT(expect_all_agree(mesh, rays), 300u);
}

}  // namespace
}  // namespace irt::test
