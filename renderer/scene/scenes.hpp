/// Scenes by name or by file: the public face of this room.
#pragma once

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

/// The scene of that name, or of that file. Throws `SceneError` if there is none or it is broken.
/// On return there is at least one triangle, four lights, and every index and number is sound.
Scene load_scene(std::string_view name_or_path);

}  // namespace irt
