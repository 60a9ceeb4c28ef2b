/// Structures over meshes that move: refitted ones answer like new ones.
#include "renderer/bvh/dynamic.hpp"

#include <bit>

#include "renderer/bvh/wide/build.hpp"
#include "renderer/bvh/wide/refit.hpp"
#include "renderer/bvh/wide/wide.hpp"
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

/// Every vertex somewhere else, up to `reach` away along each axis.
Mesh shaken(const Mesh& mesh, float reach) {
  Mesh moved = mesh;
  Random random(3);
  for (Vec3& vertex : moved.vertices) {
    vertex = vertex + random.in_box({-reach, -reach, -reach}, {reach, reach, reach});
  }
  return moved;
}

TEST(Refit, EveryStructureAnswersAsIfBuiltAnew) {
  ThreadExecutor executor(3);
  for (const Mesh& mesh : {soup(3000, 0.1f), sphere(24, 32), soup(1, 1.0f), soup(9, 0.5f)}) {
    for (const float reach : {0.0f, 0.01f, 0.3f, 3.0f}) {
      const Mesh moved = shaken(mesh, reach);
      const Rays rays = random_rays(moved, 2000);
      const Expected expected = brute_force(moved, rays);
      for (const AcceleratorEntry& entry : accelerators()) {
        SCOPED_TRACE(entry.name);
        const auto structure = entry.build(mesh, {});
        ASSERT_TRUE(structure->refit(moved, executor));
        expect_agreement(*structure, rays, expected);
      }
    }
  }
}

TEST(Refit, AnEmptyMeshStaysEmpty) {
  ThreadExecutor executor(2);
  const Mesh none;
  for (const AcceleratorEntry& entry : accelerators()) {
    const auto structure = entry.build(none, {});
    EXPECT_TRUE(structure->refit(none, executor)) << entry.name;
  }
}

TEST(Refit, WhereNothingHasMovedWideStaysAsItWasToTheBit) {
  const Mesh mesh = soup(5000, 0.1f);
  ThreadExecutor executor(2);
  const WideBvh built = build_wide(mesh, executor);
  WideBvh refitted = built;
  refit_wide(refitted, mesh, executor);
  for (std::size_t i = 0; i < built.nodes.size(); ++i) {
    for (int plane = 0; plane < 6; ++plane) {
      for (int slot = 0; slot < wide_fanout; ++slot) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(built.nodes[i].plane[plane][slot]),
                  std::bit_cast<std::uint32_t>(refitted.nodes[i].plane[plane][slot]))
            << "node " << i;
      }
    }
  }
  EXPECT_NEAR(refitted.sah_cost, built.sah_cost, 1e-4 * built.sah_cost);
}

TEST(Refit, DoesNotDependOnTheExecutor) {
  const Mesh mesh = soup(5000, 0.1f), moved = shaken(mesh, 0.1f);
  ThreadExecutor one(1), three(3);
  WideBvh a = build_wide(mesh, one), b = a;
  refit_wide(a, moved, one);
  refit_wide(b, moved, three);
  EXPECT_EQ(a.sah_cost, b.sah_cost);
  EXPECT_EQ(a.box.lo, b.box.lo);
  EXPECT_EQ(a.box.hi, b.box.hi);
}

TEST(Refit, CostsGrowTheFurtherTrianglesMove) {
  const Mesh mesh = soup(3000, 0.05f);
  ThreadExecutor executor(2);
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == "none") continue;
    SCOPED_TRACE(entry.name);
    const auto structure = entry.build(mesh, {});
    double before = structure->sah_cost();
    for (const float reach : {0.05f, 0.2f, 0.8f}) {
      structure->refit(shaken(mesh, reach), executor);
      EXPECT_GT(structure->sah_cost(), 1.2 * before);
      before = structure->sah_cost();
    }
  }
}

struct DynamicTest : testing::Test {
  Mesh mesh = soup(3000, 0.05f);
  const Mesh rest = mesh;
  ThreadExecutor executor{2};

  DynamicAccelerator make(Update update) {
    return {accelerators().front(), mesh, {}, update, executor};
  }
  void expect_right(const Accelerator& accelerator) {
    const Rays rays = random_rays(mesh, 500);
    expect_agreement(accelerator, rays, brute_force(mesh, rays));
  }
};

TEST_F(DynamicTest, DoesAsItIsTold) {
  for (const Update update : {Update::refit, Update::rebuild}) {
    DynamicAccelerator accelerator = make(update);
    for (int frame = 0; frame < 5; ++frame) {
      mesh.vertices = shaken(rest, 0.3f * static_cast<float>(frame)).vertices;
      EXPECT_EQ(accelerator.update(executor, 1000), update == Update::rebuild);
      expect_right(accelerator);
    }
  }
}

TEST_F(DynamicTest, ByCostATreeThatStaysGoodIsNeverRebuilt) {
  DynamicAccelerator accelerator = make(Update::by_cost);
  for (int frame = 0; frame < 50; ++frame) EXPECT_FALSE(accelerator.update(executor, 1000));
}

TEST_F(DynamicTest, ByCostABadTreeIsRebuiltOnceItHasCostEnough) {
  DynamicAccelerator accelerator = make(Update::by_cost);
  mesh.vertices = shaken(rest, 0.5f).vertices;
  EXPECT_FALSE(accelerator.update(executor, 0));  // nothing has been lost yet
  EXPECT_FALSE(accelerator.update(executor, 0));  // nor by frames that take no time
  const double bad = accelerator.sah_cost();
  EXPECT_TRUE(accelerator.update(executor, 1000));
  EXPECT_LT(accelerator.sah_cost(), bad);
  expect_right(accelerator);
  EXPECT_FALSE(accelerator.update(executor, 1000));  // the new tree loses nothing
}

}  // namespace
}  // namespace irt::test
