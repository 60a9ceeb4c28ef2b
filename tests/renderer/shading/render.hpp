/// Renders one frame, as a tool would.
#pragma once

#include <gtest/gtest.h>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/engine/engine.hpp"
#include "renderer/shading/image.hpp"

namespace irt {

/// Renders `scene` into `frame` with the default structure.
inline FrameStats render(const Scene& scene, FrameBuffer& frame, const QueueEntry& queue,
                         const Shader& shader, const EngineOptions& options = {},
                         std::uint32_t samples = 1) {
  const auto structure = accelerators().front().build(scene.mesh, {});
  ImageRendering application(scene.camera, frame, shader, options.rays_per_task, samples);
  return make_engine(options, queue, *structure)->run(application);
}

/// The same with the default shader.
inline FrameStats render(const Scene& scene, FrameBuffer& frame, const QueueEntry& queue,
                         const EngineOptions& options = {}, const ShaderOptions& shading = {}) {
  return render(scene, frame, queue, *shaders().front().make(scene, frame, shading), options);
}

/// Adds a square of two triangles in the plane z = `z`, with `half` the length of its side.
inline void add_square(Scene& scene, float half, float z, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(scene.mesh.vertices.size());
  scene.mesh.vertices.insert(
      scene.mesh.vertices.end(),
      {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}});
  scene.mesh.triangles.push_back({first, first + 1, first + 2});
  scene.mesh.triangles.push_back({first, first + 2, first + 3});
  scene.mesh.material.insert(scene.mesh.material.end(), 2, material);
}

/// A wall at z = 0 that fills the picture, seen from z = 10; a light above its middle.
inline Scene wall() {
  Scene scene;
  scene.materials = {{"matt", {0.5f, 0.25f, 1}, {}}, {"mirror", {}, {0.5f, 0.5f, 0.5f}}};
  scene.lights = {{{0, 0, 8}, {1, 1, 1}}};
  scene.camera = {{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 20};
  add_square(scene, 100, 0, 0);
  return scene;
}

inline void expect_near(Vec3 actual, Vec3 expected, float tolerance = 1e-5f) {
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(actual[channel], expected[channel], tolerance);
  }
}

}  // namespace irt
