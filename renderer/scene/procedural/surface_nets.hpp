/// A closed triangle mesh around the inside of an implicit surface.
#pragma once

#include "renderer/scene/scene.hpp"

namespace irt {

/// A signed field: negative inside, positive outside, roughly the distance to the surface. It may
/// err by a factor of 1.5 at most, or parts of the surface go missing.
using Field = float (*)(Vec3);

/// The region that is searched. The surface keeps two cells' distance from its faces.
struct Grid {
  Vec3 lo;
  float cell;   ///< edge length of a cell
  int size[3];  ///< cells along each axis, multiples of 4
};

/// One four-sided facet, counter-clockwise from outside: indices into `QuadMesh::vertices`.
using Quad = std::array<std::uint32_t, 4>;

struct QuadMesh {
  std::vector<Vec3> vertices;
  std::vector<Quad> quads;
};

/// Naive surface nets (Gibson, "Constrained elastic surface nets", 1998): a vertex per cell that
/// the surface crosses, moved onto the surface, and a quad around each grid edge that it crosses.
/// Every edge of the result joins as many quads from one side as from the other.
QuadMesh surface_nets(Field field, const Grid& grid);

/// `p` moved onto the nearby zero of `field` by one Newton step; `h` is the width of the
/// differences that give the gradient.
Vec3 onto_surface(Field field, Vec3 p, float h);

/// The direction in which `field` grows fastest, of length 1.
Vec3 field_normal(Field field, Vec3 p, float h);

}  // namespace irt
