/// The bits of brute force on the scenes that frames are made of.
#include "renderer/scene/scenes.hpp"
#include "tests/renderer/bvh/agreement.hpp"

namespace irt::test {
namespace {

TEST(StandIns, EveryStructureAgrees) {
  for (const SceneEntry& entry : built_in_scenes()) {
    SCOPED_TRACE(entry.name);
    const Scene scene = entry.make();
    EXPECT_GT(expect_all_agree(scene.mesh, random_rays(scene.mesh, 200)), 10u);
  }
}

}  // namespace
}  // namespace irt::test
