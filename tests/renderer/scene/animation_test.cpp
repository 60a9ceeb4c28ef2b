#include "renderer/scene/animation.hpp"

#include <gtest/gtest.h>

#include "renderer/scene/scenes.hpp"

namespace irt {
namespace {

float furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, length(a[i] - b[i]));
  return most;
}

TEST(Animation, StartsAtRestMovesAndComesBack) {
  for (const SceneEntry& scene : built_in_scenes()) {
    const Mesh rest = scene.make().mesh;
    Vec3 low = rest.vertices.front(), high = low;
    for (const Vec3 vertex : rest.vertices) {
      low = min(low, vertex);
      high = max(high, vertex);
    }
    const float size = length(high - low);
    for (const AnimationEntry& entry : animations()) {
      SCOPED_TRACE(std::string(scene.name) + " " + std::string(entry.name));
      const auto animation = entry.make(rest);
      Mesh mesh = rest;
      animation->pose(0, mesh);
      EXPECT_LT(furthest(rest.vertices, mesh.vertices), 1e-5f * size);
      animation->pose(17, mesh);
      const std::vector<Vec3> pose = mesh.vertices;
      EXPECT_GT(furthest(rest.vertices, pose), 0.005f * size);
      EXPECT_LT(furthest(rest.vertices, pose), size);
      // A pose depends on the frame alone: not on what was there before, nor on the round.
      animation->pose(90, mesh);
      animation->pose(animation_period + 17, mesh);
      EXPECT_EQ(mesh.vertices, pose);
      // No jumps: from frame to frame it is a small part of the way.
      animation->pose(18, mesh);
      EXPECT_LT(furthest(pose, mesh.vertices), 0.1f * size);
    }
  }
}

TEST(Animation, TurnKeepsShapesAndWhatStandsBeside) {
  // Two tetrahedra: the one with more triangles turns.
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}, {4, 5, 6}};
  const Mesh rest = mesh;
  const auto turn = animations().front().make(mesh);
  for (std::uint32_t frame = 0; frame < animation_period; ++frame) {
    turn->pose(frame, mesh);
    for (std::size_t i = 4; i < 7; ++i) EXPECT_EQ(mesh.vertices[i], rest.vertices[i]);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_NEAR(length(mesh.vertices[i] - mesh.vertices[k]),
                    length(rest.vertices[i] - rest.vertices[k]), 1e-5f);
      }
    }
  }
}

}  // namespace
}  // namespace irt
