/// Simple solids, appended to a mesh: what the stand-ins are put together from.
///
/// Normals point outwards. Everything comes from +, -, *, / and square roots, which round the same
/// on every machine; sines and cosines are made here for that reason.
#pragma once

#include <cstddef>
#include <span>

#include "renderer/scene/scene.hpp"

namespace irt {

/// Appends a vertex and returns its index.
std::uint32_t add_vertex(Mesh& mesh, Vec3 position);

/// Appends the triangle of three vertices that are in the mesh.
void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  std::uint32_t material);

/// A box along the axes: 12 triangles.
void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, std::uint32_t material);

/// The quadrilateral `a b c d`, counter-clockwise from the front, cut into `across` (from a to b)
/// times `along` (from a to d) cells of two triangles.
void add_patch(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d, int across, int along,
               std::uint32_t material);

/// A box with rounded edges and swelling sides: 12 n^2 triangles.
void add_cushion(Mesh& mesh, Vec3 lo, Vec3 hi, int n, std::uint32_t material);

/// One ring of a turned solid.
struct Ring {
  float radius;  ///< 0: a point
  float height;  ///< over the solid's origin
};

/// The solid that `profile`, from bottom to top on the outside, sweeps when it turns around the
/// vertical axis through `origin`: 2 * segments triangles between rings, half as many at a point.
void add_turned(Mesh& mesh, Vec3 origin, std::span<const Ring> profile, int segments,
                std::uint32_t material);

/// A ball of `rings` bands: 2 * segments * (rings - 1) triangles.
void add_ball(Mesh& mesh, Vec3 centre, float radius, int segments, int rings,
              std::uint32_t material);

/// A rod along a path of at least two different points, closed at both ends:
/// 2 * sides * points triangles.
void add_rod(Mesh& mesh, std::span<const Vec3> path, float radius, int sides,
             std::uint32_t material);

/// A leaf from `root` over `middle` to `tip`, `width` at its widest: a strip of exactly
/// `triangles`, at least one.
void add_leaf(Mesh& mesh, Vec3 root, Vec3 middle, Vec3 tip, float width, int triangles,
              std::uint32_t material);

/// Cosine and sine of a part of a full turn.
struct Turn {
  explicit Turn(double turns);
  float cos, sin;
};

/// Turns the vertices from index `first` on around the vertical axis (from +z towards +x, by parts
/// of a full turn), then moves them by `offset`.
void place(Mesh& mesh, std::size_t first, double turns, Vec3 offset);

}  // namespace irt
