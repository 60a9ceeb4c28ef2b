/// Wald's hierarchy by whole tasks: the bits of brute force for every kernel, width and instruction
/// set.
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

TEST(WaldPackets, IncoherentRays) {
  const Mesh mesh = soup(1000, 0.2f);
  EXPECT_GT(expect_every_way_agrees("wald", mesh, random_rays(mesh, 1001)), 200u);
}

TEST(WaldPackets, CoherentRaysOfOneOctant) {
  const Mesh mesh = sphere(24, 32);
  Rays rays(40 * 40);
  for (int i = 0; i < 1600; ++i) {
    const int row = i / 40, column = i % 40;
    const auto x = static_cast<float>(column) * 0.05f, y = static_cast<float>(row) * 0.05f;
    rays.add({{-3, -3, -3}, {2 + x, 2 + y, 3}}, {1, 1, 1}, 0);
  }
  EXPECT_GT(expect_every_way_agrees("wald", mesh, rays), 1400u);
}

TEST(WaldPackets, BadInputs) {
  EXPECT_EQ(expect_every_way_agrees("wald", Mesh(), random_rays(soup(5, 0.2f), 50)), 0u);
  Mesh mesh = soup(400, 0.5f);
  for (std::uint32_t i = 0; i < 400; ++i) {
    add_triangle(mesh, mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2));
  }
  Rays rays = random_rays(mesh, 100);
  Rays mixed(110);
  for (std::uint32_t i = 0; i < 100; ++i) {
    mixed.add(rays.ray(i), {1, 1, 1}, 0);
    if (i % 10 == 3) mixed.add({{nan, 0, 0}, {1, inf, 0}}, {1, 1, 1}, 0);
  }
  EXPECT_GT(expect_every_way_agrees("wald", mesh, mixed), 20u);
  EXPECT_EQ(expect_every_way_agrees("wald", mesh, Rays(0)), 0u);
  EXPECT_EQ(expect_every_way_agrees("wald", mesh, Rays(16)), 0u);
}

}  // namespace
}  // namespace irt::test
