/// What takes minutes: run by `irt test --full`.
#include <algorithm>
#include <array>
#include <chrono>

#include "renderer/scene/scenes.hpp"
#include "tests/renderer/bvh/agreement.hpp"
#include "tests/renderer/bvh/watertight.hpp"

namespace irt::test {
namespace {

class PerStandIn : public testing::TestWithParam<const char*> {};

TEST_P(PerStandIn, HundredThousandRaysAgreeWithBruteForce) {
  const Mesh mesh = load_scene(GetParam()).mesh;
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 100'000)), 10'000u);
}
INSTANTIATE_TEST_SUITE_P(Full, PerStandIn, testing::Values("bunny", "office", "conference"),
                         [](const auto& name) { return std::string(name.param); });

/// The thesis: 102 to 1,040 times (table 5.2).
TEST(Full, GoncalvesIsAHundredTimesBruteForce) {
  using Clock = std::chrono::steady_clock;
  for (const SceneEntry& entry : built_in_scenes()) {
    const Scene scene = entry.make();
    const auto seconds_per_ray = [&scene](const Accelerator& accelerator, std::uint32_t count) {
      const Rays rays = random_rays(scene.mesh, count);
      Hits hits(count);
      const auto start = Clock::now();
      accelerator.closest_hit(rays, hits);
      return std::chrono::duration<double>(Clock::now() - start).count() / count;
    };
    const auto brute = build("none", scene.mesh), tree = build("goncalves", scene.mesh);
    std::array<double, 5> ratio{};
    for (double& r : ratio) r = seconds_per_ray(*brute, 200) / seconds_per_ray(*tree, 20'000);
    std::ranges::sort(ratio);
    RecordProperty(std::string(entry.name), std::to_string(ratio[2]));
    EXPECT_GE(ratio[2], 100) << entry.name << ": median of five, least " << ratio[0] << ", most "
                             << ratio[4];
  }
}

TEST(Full, TenMillionRaysAtSeamsPassNowhere) {
  expect_no_leak(10'000'000, 120, 160);
}

TEST(Full, MillionTriangles) {
  const Mesh mesh = soup(1'000'000, 0.01f);
  EXPECT_GT(expect_all_agree(mesh, random_rays(mesh, 1000)), 200u);
}

}  // namespace
}  // namespace irt::test
