// Scenes and pictures of unusual size.
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/scene/scenes.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/shading/render.hpp"

namespace irt {
namespace {

// `scene` in another unit of length.
Scene scaled(Scene scene, float scale) {
  for (Vec3& vertex : scene.mesh.vertices) vertex = vertex * scale;
  for (PointLight& light : scene.lights) light.position = light.position * scale;
  scene.camera.eye = scene.camera.eye * scale;
  scene.camera.target = scene.camera.target * scale;
  return scene;
}

// The picture does not depend on the unit: to the last bit where the scale is a power of two, which
// rounds nothing, and but for a few pixels at edges where it is not.
TEST(Robust, HugeAndTinyScenesGiveTheSamePicture) {
  for (const SceneEntry& entry : built_in_scenes()) {
    SCOPED_TRACE(entry.name);
    const Scene scene = entry.make();
    FixedPointFrameBuffer expected(64, 64);
    render(scene, expected, plain_queue);
    for (const int exponent : {-20, 20}) {  // about 1e-6 and 1e6
      FixedPointFrameBuffer frame(64, 64);
      render(scaled(scene, std::ldexp(1.0f, exponent)), frame, plain_queue);
      EXPECT_EQ(frame.hash(), expected.hash()) << "2^" << exponent;
    }
    for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
      FixedPointFrameBuffer frame(64, 64);
      render(scaled(scene, scale), frame, plain_queue);
      const Image a = expected.image(), b = frame.image();
      int differing = 0;
      for (std::size_t i = 0; i < a.rgb.size(); ++i) differing += std::abs(a.rgb[i] - b.rgb[i]) > 2;
      EXPECT_LT(differing, 64 * 64 * 3 / 100) << scale;
    }
  }
}

TEST(Robust, AnySizeOfPictureAndTaskWithAnyWidth) {
  Scene scene = load_scene("office");
  scene.mesh.triangles.resize(3000);
  for (const auto& [width, height] : {std::pair{1u, 1u}, {17u, 3u}, {37u, 29u}}) {
    std::uint64_t expected = 0;
    for (const unsigned packet : {1u, 4u, 8u, 16u}) {
      const auto structure = accelerators().front().build(scene.mesh, {.width = packet});
      for (const std::uint32_t rays : {1u, 5u, 256u}) {
        FixedPointFrameBuffer frame(width, height);
        const auto shader = shaders().front().make(scene, frame, {});
        ImageRendering application(scene.camera, frame, *shader, rays);
        make_engine({.rays_per_task = rays}, plain_queue, *structure)->run(application);
        if (expected == 0) expected = frame.hash();
        EXPECT_EQ(frame.hash(), expected)
            << width << "x" << height << ", packets of " << packet << ", tasks of " << rays;
      }
    }
  }
}

TEST(Robust, ASceneOfOneTriangle) {
  for (const ShaderEntry& entry : shaders()) {
    Scene scene = wall();
    scene.mesh.triangles.resize(1);
    scene.mesh.material.resize(1);
    FixedPointFrameBuffer frame(16, 16);
    const FrameStats stats = render(scene, frame, plain_queue, *entry.make(scene, frame, {}));
    EXPECT_GE(stats.rays(), frame.pixels()) << entry.name;
    EXPECT_EQ(stats.lost + stats.doubled, 0u) << entry.name;
  }
}

}  // namespace
}  // namespace irt
