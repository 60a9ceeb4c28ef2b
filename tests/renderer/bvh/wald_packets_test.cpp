/// Wald's hierarchy by whole tasks: the bits of brute force for every kernel, width and instruction
/// set.
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

/// Returns how many instruction sets this machine could try.
int expect_every_way_agrees(const Mesh& mesh, const Rays& rays) {
  int tried = 0;
  for (const TriangleKernelEntry& kernel : triangle_kernels()) {
    const Expected expected = brute_force(mesh, rays, {.kernel = kernel.kernel});
    for (const char* const isa : {"", "sse4", "avx2", "avx512", "neon"}) {
      for (const unsigned width : {4u, 8u, 16u}) {
        SCOPED_TRACE(::testing::Message() << kernel.name << " " << isa << " width " << width);
        std::unique_ptr<Accelerator> accelerator;
        try {
          accelerator = build("wald", mesh, {kernel.kernel, width, isa});
        } catch (const std::invalid_argument&) {
          continue;
        }
        ++tried;
        expect_agreement(*accelerator, rays, expected);
      }
    }
  }
  return tried / 12;
}

TEST(WaldPackets, IncoherentRays) {
  const Mesh mesh = soup(1000, 0.2f);
  EXPECT_GE(expect_every_way_agrees(mesh, random_rays(mesh, 1001)), 2);
}

TEST(WaldPackets, CoherentRaysOfOneOctant) {
  const Mesh mesh = sphere(24, 32);
  Rays rays(40 * 40);
  for (int i = 0; i < 1600; ++i) {
    const int row = i / 40, column = i % 40;
    const auto x = static_cast<float>(column) * 0.05f, y = static_cast<float>(row) * 0.05f;
    rays.add({{-3, -3, -3}, {2 + x, 2 + y, 3}}, {1, 1, 1}, 0);
  }
  EXPECT_GE(expect_every_way_agrees(mesh, rays), 2);
}

TEST(WaldPackets, BadInputs) {
  EXPECT_GE(expect_every_way_agrees(Mesh(), random_rays(soup(5, 0.2f), 50)), 2);
  Mesh mesh = soup(400, 0.5f);
  for (std::uint32_t i = 0; i < 400; ++i) {
    add_triangle(mesh, mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2));
  }
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Rays rays = random_rays(mesh, 100);
  Rays mixed(110);
  for (std::uint32_t i = 0; i < 100; ++i) {
    mixed.add(rays.ray(i), {1, 1, 1}, 0);
    if (i % 10 == 3) mixed.add({{nan, 0, 0}, {1, inf, 0}}, {1, 1, 1}, 0);
  }
  EXPECT_GE(expect_every_way_agrees(mesh, mixed), 2);
  EXPECT_EQ(expect_every_way_agrees(mesh, Rays(0)), expect_every_way_agrees(mesh, Rays(16)));
}

}  // namespace
}  // namespace irt::test
