/// Reader of PLY meshes (Turk, "The PLY polygon file format", 1994).
#pragma once

#include <string_view>

#include "renderer/scene/scene.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt {

/// The mesh in `bytes`, a whole PLY file: ASCII or binary of either byte order; x, y and z of any
/// scalar type; faces as lists of any integer types, cut into fans. Other elements and properties
/// are skipped. Every triangle has material 0. Throws `SceneError`. Memory and time are bounded by
/// the size of `bytes`, whatever counts its header claims.
Mesh parse_ply(std::string_view bytes);

}  // namespace irt
