/// What a `Scene` promises of every mesh, light, material and camera.
#pragma once

#include <cmath>
#include <gtest/gtest.h>

#include "renderer/scene/scene.hpp"

namespace irt {

inline bool is_finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline void expect_sound(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  ASSERT_FALSE(mesh.triangles.empty());
  ASSERT_EQ(mesh.material.size(), mesh.triangles.size());
  for (const Vec3 v : mesh.vertices) ASSERT_TRUE(is_finite(v));
  for (const auto& triangle : mesh.triangles) {
    for (const auto index : triangle) ASSERT_LT(index, mesh.vertices.size());
  }
  for (const auto index : mesh.material) ASSERT_LT(index, scene.materials.size());
  EXPECT_FALSE(scene.lights.empty());
  for (const PointLight& light : scene.lights) EXPECT_TRUE(is_finite(light.position));
  EXPECT_TRUE(is_finite(scene.camera.eye) && is_finite(scene.camera.target));
  EXPECT_NE(scene.camera.eye, scene.camera.target);
}

/// True if some triangle reflects.
inline bool has_mirror(const Scene& scene) {
  for (const auto index : scene.mesh.material) {
    if (scene.materials[index].specular != Vec3{}) return true;
  }
  return false;
}

}  // namespace irt
