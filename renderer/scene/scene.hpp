/// A scene: triangles with materials, point lights and a camera.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "renderer/scene/vec3.hpp"

namespace irt {

/// Three indices into `Mesh::vertices`.
using TriangleIndices = std::array<std::uint32_t, 3>;

/// An indexed triangle mesh in world space. Every index is in range and every vertex finite:
/// readers and generators guarantee it. Degenerate and duplicate triangles are allowed.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<TriangleIndices> triangles;
  std::vector<std::uint32_t> material;  ///< per triangle, an index into `Scene::materials`

  [[nodiscard]] Vec3 corner(std::uint32_t triangle, int k) const {
    return vertices[triangles[triangle][static_cast<std::size_t>(k)]];
  }
};

/// Lambertian plus a perfect mirror, as the thesis' shader wants it (chapter 4).
struct Material {
  std::string name;
  Vec3 diffuse{0.7f, 0.7f, 0.7f};  ///< albedo per channel, in [0, 1]
  Vec3 specular{};                 ///< mirror reflectance per channel, in [0, 1]; 0: no ray
};

struct PointLight {
  Vec3 position;
  /// Radiance that a white surface facing the light reflects, per channel. There is no fall-off
  /// with distance, so that a scene looks alike in metres and in millimetres.
  Vec3 intensity{1, 1, 1};
};

/// A pinhole camera.
struct Camera {
  Vec3 eye{0, 0, 1};
  Vec3 target{};
  Vec3 up{0, 1, 0};
  float vertical_fov = 60;  ///< degrees, in (0, 180)
};

struct Scene {
  std::string name;
  Mesh mesh;
  std::vector<Material> materials;
  std::vector<PointLight> lights;
  Camera camera;
};

}  // namespace irt
