#include "renderer/scene/scenes.hpp"

#include <string>

#include "renderer/scene/stand_ins.hpp"

namespace irt {

std::span<const SceneEntry> built_in_scenes() {
  static constexpr SceneEntry entries[] = {
      {"bunny", "69,463 triangles: a small animal, evenly tessellated, beside a mirror",
       make_bunny},
      {"office", "20,769 triangles: a small room, large walls and small things", make_office},
      {"conference", "190,951 triangles: a hall with furniture, most of it in small pieces",
       make_conference},
  };
  return entries;
}

Scene load_scene(std::string_view name_or_path) {
  for (const SceneEntry& entry : built_in_scenes()) {
    if (entry.name == name_or_path) return entry.make();
  }
  std::string names;
  for (const SceneEntry& entry : built_in_scenes()) names += " " + std::string(entry.name);
  throw SceneError("scene '" + std::string(name_or_path) + "': no such scene; there are:" + names);
}

}  // namespace irt
