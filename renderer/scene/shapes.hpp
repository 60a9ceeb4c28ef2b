/// Simple solids, appended to a mesh.
#pragma once

#include "renderer/scene/scene.hpp"

namespace irt {

/// Appends a vertex and returns its index.
std::uint32_t add_vertex(Mesh& mesh, Vec3 position);

/// Appends the triangle of three vertices that are in the mesh.
void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  std::uint32_t material);

/// A box along the axes: 12 triangles, their normals outwards.
void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, std::uint32_t material);

}  // namespace irt
