/// The triangles of a mesh with their corners side by side, as builders and tests want them.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/intersection.hpp"

namespace irt {

inline Triangle triangle_of(const Mesh& mesh, std::uint32_t index) {
  return {mesh.corner(index, 0), mesh.corner(index, 1), mesh.corner(index, 2)};
}

/// All triangles of `mesh` in their order.
inline std::vector<Triangle> corners(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    triangles.push_back(triangle_of(mesh, i));
  }
  return triangles;
}

}  // namespace irt
