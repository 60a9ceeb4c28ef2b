/// The wide builder: the same tree whoever builds it, and a tree that is one.
#include "renderer/bvh/wide/build.hpp"

#include <chrono>
#include <cstring>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <thread>
#include <vector>

#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {
namespace {

bool same(const WideBvh& a, const WideBvh& b) {
  return a.nodes.size() == b.nodes.size() && a.blocks.size() == b.blocks.size() &&
         std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(WideNode)) == 0 &&
         std::memcmp(a.blocks.data(), b.blocks.data(), a.blocks.size() * sizeof(WideBlock)) == 0 &&
         a.sah_cost == b.sah_cost;
}

TEST(WideBuild, ThreadsDoNotMatter) {
  const Mesh mesh = soup(60000, 0.02f);
  ThreadExecutor alone(1);
  const WideBvh once = build_wide(mesh, alone);
  for (const unsigned threads : {2u, 3u, 8u}) {
    ThreadExecutor many(threads);
    EXPECT_TRUE(same(once, build_wide(mesh, many))) << threads << " threads";
  }
}

TEST(WideBuild, InstructionSetsDoNotMatter) {
  const Mesh mesh = soup(20000, 0.02f);
  ThreadExecutor executor(1);
  const WideBvh best = build_wide(mesh, executor);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    EXPECT_TRUE(same(best, build_wide(mesh, executor))) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

#if defined(__x86_64__)
// They slow arithmetic down by an order of magnitude, and the builder has integers in free lanes.
TEST(WideBuild, CalculatesWithoutDenormalNumbers) {
  constexpr unsigned met_denormal = 1u << 1;  // of MXCSR
  ThreadExecutor executor(1);
  const Mesh mesh = soup(5000, 0.02f);
  __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() & ~met_denormal);
  const WideBvh bvh = build_wide(mesh, executor);
  EXPECT_EQ(__builtin_ia32_stmxcsr() & met_denormal, 0u) << bvh.nodes.size() << " nodes";
}
#endif

/// Walks the tree and notes how often it comes by each triangle.
struct Inspector {
  const WideBvh& bvh;
  const Mesh& mesh;
  std::vector<int> seen = std::vector<int>(mesh.triangles.size());
  int deepest = 0;

  void visit(std::uint32_t index, const Box& around, int depth) {
    deepest = std::max(deepest, depth);
    const WideNode& node = bvh.nodes[index];
    for (int i = 0; i < wide_fanout; ++i) {
      const Box box{{node.plane[0][i], node.plane[1][i], node.plane[2][i]},
                    {node.plane[3][i], node.plane[4][i], node.plane[5][i]}};
      if (box.lo.x > box.hi.x) continue;
      Box both = around;
      both.grow(box);
      EXPECT_EQ(both.lo, around.lo);
      EXPECT_EQ(both.hi, around.hi);
      const WideChild child = node.child[i];
      if (!child.is_leaf()) {
        ASSERT_GT(child.node(), index) << "depth first";
        visit(child.node(), box, depth + 1);
        continue;
      }
      for (std::uint32_t lane = 0; lane < child.count(); ++lane) {
        const WideBlock& block = bvh.blocks[child.first_block() + lane / wide_block];
        const std::uint32_t triangle = block.index[lane % wide_block];
        ++seen[triangle];
        const Box own = padded_bounds(
            {mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2)});
        Box around_own = box;
        around_own.grow(own);
        EXPECT_EQ(around_own.lo, box.lo);
        EXPECT_EQ(around_own.hi, box.hi);
      }
    }
  }
};

void expect_sound(const Mesh& mesh) {
  ThreadExecutor executor(2);
  const WideBvh bvh = build_wide(mesh, executor);
  Inspector inspector{bvh, mesh};
  inspector.visit(0, bvh.box, 1);
  EXPECT_LE(inspector.deepest, wide_most_depth);
  for (const int times : inspector.seen) ASSERT_EQ(times, 1);
}

TEST(WideBuild, EveryTriangleIsInOneLeafInsideOfItsBoxes) {
  expect_sound(soup(1, 0.1f));
  expect_sound(soup(4, 0.1f));
  expect_sound(soup(5, 0.1f));
  expect_sound(soup(9, 0.1f));
  expect_sound(soup(40000, 0.01f));
  expect_sound(sphere(40, 60));
}

TEST(WideBuild, ManyInOnePlaceAreHalved) {
  Mesh mesh;
  for (int i = 0; i < 40000; ++i) add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  expect_sound(mesh);
}

TEST(WideBuild, ExponentialSpacingStaysShallow) {
  Mesh mesh;
  for (int i = 0; i < 240; ++i) {
    const float x = std::ldexp(1.0f, i - 120);
    for (int copy = 0; copy < 10; ++copy) add_triangle(mesh, {x, 0, 0}, {x, x, 0}, {x, 0, x});
  }
  expect_sound(mesh);
}

TEST(WideBuild, NothingOfNothing) {
  ThreadExecutor executor(2);
  EXPECT_TRUE(build_wide(Mesh{}, executor).nodes.empty());
}

TEST(ThreadExecutor, CallsEveryJobOnce) {
  ThreadExecutor executor(4);
  for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> called(count);
    executor.for_each(count, [&](std::size_t i) { ++called[i]; });
    for (const auto& times : called) ASSERT_EQ(times, 1);
  }
}

TEST(ThreadExecutor, ShortCallsInARowSeeWhatTheLastOnesWrote) {
  ThreadExecutor executor(5);  // more than cores: helpers come late, sleep, or miss a call
  std::vector<std::size_t> values(7);
  constexpr std::size_t calls = 3000;
  for (std::size_t call = 0; call < calls; ++call) {
    executor.for_each(values.size(), [&](std::size_t i) { values[i] += (call + i) % 3; });
    if (call % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (const std::size_t value : values) ASSERT_EQ(value, calls);
}

}  // namespace
}  // namespace irt::test
