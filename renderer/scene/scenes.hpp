/// Scenes by name or by file: the public face of this room.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "renderer/scene/scene.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt {

/// A scene by name, as the tools see it.
struct SceneEntry {
  std::string_view name;
  std::string_view summary;
  Scene (*make)();
};

/// The scenes that are made by code, with the thesis' triangle counts; the default first. They need
/// no file, cannot fail, and are the same to the bit on every machine.
std::span<const SceneEntry> built_in_scenes();

/// The thesis' models as far as they are public. `make` throws `SceneError` where
/// `scene_data_folder()` has not their files.
std::span<const SceneEntry> real_scenes();

/// Where meshes of scene files are looked for that are not beside the file: the environment
/// variable IRT_SCENES, else `../shared/scenes` from the project's root.
std::filesystem::path scene_data_folder();

/// The scene of that name, or of that file: a scene file (.json; docs/scenes.md) or a bare mesh
/// (.ply, .obj), which gets four lights and a camera that sees all of it. Throws `SceneError` if
/// there is none or it is broken. On return there are a triangle, a light and a material at least,
/// every index is in range and every number is finite.
Scene load_scene(std::string_view name_or_path);

}  // namespace irt
