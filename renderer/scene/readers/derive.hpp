/// What a scene lacks, made from the bounds of its mesh.
#pragma once

#include <vector>

#include "renderer/scene/scene.hpp"

namespace irt {

/// The smallest box around the vertices that triangles use.
struct Bounds {
  Vec3 lo, hi;
};
Bounds bounds_of(const Mesh& mesh);

/// The material of faces that name none: light grey with a faint mirror.
Material default_material();

/// A camera in front (+z) of the bounds and a little above that sees all of them. Right for an
/// object; a room needs a scene file that says where in it to stand.
Camera derived_camera(const Bounds& bounds);

/// Four lights above the camera's side of the bounds, outside of them, of total intensity 1.2.
std::vector<PointLight> derived_lights(const Bounds& bounds);

}  // namespace irt
