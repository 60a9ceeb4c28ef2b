// What each shader shows of scenes whose pictures can be worked out.
#include <gtest/gtest.h>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/shading/ambient_occlusion.hpp"
#include "renderer/shading/whitted.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/shading/render.hpp"

namespace irt {
namespace {

const ShaderEntry& shader_called(std::string_view name) {
  for (const ShaderEntry& entry : shaders()) {
    if (entry.name == name) return entry;
  }
  throw std::runtime_error("no such shader");
}

// What the camera of `scene` looks at, so narrowly that all samples meet about one point.
Vec3 middle(Scene scene, std::string_view shader, std::uint32_t samples = 1) {
  scene.camera.vertical_fov = 0.01f;
  FixedPointFrameBuffer frame(1, 1);
  render(scene, frame, plain_queue, *shader_called(shader).make(scene, frame, {}), {}, samples);
  return frame.sum(0);
}

TEST(Shaders, DiffuseCastsNoShadow) {
  Scene scene = wall();
  scene.camera.eye = {3, 0, 4};
  add_square(scene, 0.1f, 7.5f, 0);  // between the light and what is seen
  const float aslant = 1;            // the light stands over the target
  expect_near(middle(scene, "diffuse"), scene.materials[0].diffuse * (aslant + Whitted::ambient));
  expect_near(middle(scene, "whitted"), scene.materials[0].diffuse * Whitted::ambient);
}

TEST(Shaders, NormalsLookAtTheViewer) {
  Scene scene = wall();
  expect_near(middle(scene, "normals"), {0.5f, 0.5f, 1});
  scene.camera.eye = {0, 0, -10};
  expect_near(middle(scene, "normals"), {0.5f, 0.5f, 0});
}

TEST(Shaders, DepthIsHalfAtTheTarget) {
  Scene scene = wall();
  expect_near(middle(scene, "depth"), {0.5f, 0.5f, 0.5f});
  scene.camera.target = {0, 0, -10};  // twice as far: the wall is at a quarter of what is shown
  expect_near(middle(scene, "depth"), {0.75f, 0.75f, 0.75f});
}

TEST(Shaders, AnOpenWallIsNotOccludedAndACoveredOneIs) {
  Scene scene = wall();
  expect_near(middle(scene, "ambient-occlusion"), {1, 1, 1});
  scene.camera.eye = {0, 0, 0.05f};
  add_square(scene, 100, 0.1f, 0);  // behind the eye
  expect_near(middle(scene, "ambient-occlusion"), {});
  // As far away as the wall is wide it is beyond the reach.
  scene = wall();
  add_square(scene, 100, 200, 0);
  expect_near(middle(scene, "ambient-occlusion"), {1, 1, 1});
}

TEST(Shaders, APathThatMeetsOneSurfaceBringsTheSkyTimesWhatItReflects) {
  Scene scene = wall();
  scene.lights[0].intensity = {};
  scene.materials[0] = {"both", {0.5f, 0.5f, 0.5f}, {0.25f, 0.25f, 0.25f}};
  // Mirrored or scattered, drawn by their shares: each path brings 3/4 of the sky.
  expect_near(middle(scene, "path", 64), Whitted::background * 0.75f, 1e-4f);
}

TEST(Shaders, PathsBetweenTwoWallsAddUpTheReflections) {
  // Two endless walls that face each other, the light between them: of albedo a, each point gets
  // the light directly from its cosine and again a times what the walls show. Only the depth limit
  // lets light go, so the middle is brighter than without reflections and below the endless sum.
  Scene scene = wall();
  scene.materials[0].diffuse = {0.5f, 0.5f, 0.5f};
  add_square(scene, 100, 20, 0);
  const float direct = 0.5f;
  const float all = middle(scene, "path", 256).x;
  EXPECT_GT(all, direct + 0.05f);
  EXPECT_LT(all, 2 * direct);
}

TEST(Shaders, ManyLightsAreEachAskedInTheirTurn) {
  // One light of 64 is asked per hit and stands for all: the mean is their sum.
  Scene scene = wall();
  scene.lights.assign(64, scene.lights[0]);
  for (PointLight& light : scene.lights) light.intensity = {1.0f / 64, 1.0f / 64, 1.0f / 64};
  scene.materials[0].specular = {};
  const Vec3 sky = scene.materials[0].diffuse * Whitted::background;
  expect_near(middle(scene, "path", 32), scene.materials[0].diffuse + sky, 1e-3f);
}

TEST(Shaders, SamplesAverageAndEveryRayContributesOnce) {
  Scene scene = wall();
  scene.materials[0].specular = {0.3f, 0.3f, 0.3f};
  add_square(scene, 1, 2, 1);
  for (const ShaderEntry& entry : shaders()) {
    SCOPED_TRACE(entry.name);
    FixedPointFrameBuffer frame(20, 12);
    const auto shader = entry.make(scene, frame, {.max_depth = 2});
    const FrameStats stats = render(scene, frame, plain_queue, *shader, {.rays_per_task = 50}, 5);
    std::uint64_t contributions = 0, most = 0;
    for (std::uint32_t pixel = 0; pixel < frame.pixels(); ++pixel) {
      contributions += frame.contributions(pixel);
      most = std::max(most, frame.contributions(pixel));
    }
    EXPECT_EQ(contributions, stats.rays());
    EXPECT_EQ(stats.total().rays[0], 5u * frame.pixels());
    EXPECT_LE(most, 5 * shader->max_rays_per_sample());
  }
}

}  // namespace
}  // namespace irt
