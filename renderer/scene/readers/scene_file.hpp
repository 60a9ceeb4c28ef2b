/// Reader of scene files: JSON that names meshes, boxes, materials, lights and a camera.
/// docs/scenes.md is its reference.
#pragma once

#include <functional>
#include <string_view>

#include "renderer/scene/readers/obj.hpp"

namespace irt {

/// Reads the mesh file that a scene file names. Throws `SceneError`.
using MeshLoader = std::function<MeshWithMaterials(std::string_view file)>;

/// The scene in `text`, a whole scene file. Throws `SceneError`.
Scene parse_scene(std::string_view text, const MeshLoader& load_mesh);

}  // namespace irt
