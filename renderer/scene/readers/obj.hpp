/// Reader of Wavefront OBJ meshes with MTL materials.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/scene.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt {

/// A mesh with materials of its own.
struct MeshWithMaterials {
  Mesh mesh;
  std::vector<Material> materials;  ///< at least one
};

/// The text of a material library by the name that the OBJ gives it. Throws `SceneError` or returns
/// nothing useful at its own choice; a missing library is best answered with an empty text.
using MaterialLibrary = std::function<std::string(std::string_view file)>;

/// The mesh in `text`, a whole OBJ file: `v`, `f` (polygons cut into fans, indices from either
/// end), `usemtl` and `mtllib`; all else is skipped. Faces under no material, or one that no
/// library has, get the default material. Throws `SceneError`; time and memory are bounded by the
/// text.
///
/// The lines are taken apart here and not by tinyobjloader, which reads `nan` as 0 and the index
/// 4294967297 as 1 without a word; it reads the libraries.
MeshWithMaterials parse_obj(std::string_view text, const MaterialLibrary& library);

/// The materials of a whole MTL file: Kd is the diffuse albedo; Ks the mirror reflectance, unless
/// `illum` is 1 or 2, which ask for no reflection. Both are clamped to [0, 1]. `Ns`, the width of a
/// highlight, has no meaning for a perfect mirror and is skipped, as are textures.
std::vector<Material> parse_mtl(std::string_view text);

}  // namespace irt
