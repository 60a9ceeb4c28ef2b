#include "renderer/scene/scenes.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <new>
#include <string>
#include <utility>

#include "renderer/scene/procedural/stand_ins.hpp"
#include "renderer/scene/readers/derive.hpp"
#include "renderer/scene/readers/input.hpp"
#include "renderer/scene/readers/obj.hpp"
#include "renderer/scene/readers/ply.hpp"
#include "renderer/scene/readers/scene_file.hpp"

namespace irt {
namespace {

namespace fs = std::filesystem;

/// A mesh file with the materials that it brings. Throws `SceneError` without the file's name.
MeshWithMaterials parse_mesh(const fs::path& path) {
  const std::string bytes = read_file(path);
  if (path.extension() == ".ply") return {parse_ply(bytes), {default_material()}};
  return parse_obj(bytes, [&path](std::string_view library) -> std::string {
    std::error_code error;
    const fs::path file = path.parent_path() / library;
    // Without its library a mesh is grey, and still worth looking at.
    return fs::is_regular_file(file, error) ? read_file(file) : std::string();
  });
}

bool is_mesh_file(const fs::path& path) {
  return path.extension() == ".ply" || path.extension() == ".obj";
}

/// As `parse_mesh`; the message starts with the file's name.
MeshWithMaterials load_mesh(const fs::path& path) {
  try {
    return parse_mesh(path);
  } catch (const SceneError& error) {
    throw SceneError(fmt::format("mesh {}: {}", in_quotes(path.native()), error.what()));
  }
}

/// The mesh that a scene file in `folder` names.
MeshWithMaterials load_named_mesh(const fs::path& folder, std::string_view name) {
  if (!is_mesh_file(name)) {
    throw SceneError(fmt::format("mesh {}: meshes are .ply or .obj files", in_quotes(name)));
  }
  std::error_code error;
  for (const fs::path& place : {folder, scene_data_folder()}) {
    if (fs::exists(place / name, error)) return load_mesh(place / name);
  }
  throw SceneError(
      fmt::format("mesh {} is neither beside the scene file nor in {}; set IRT_SCENES to the "
                  "folder that has it",
                  in_quotes(name), in_quotes(scene_data_folder().native())));
}

Scene load_scene_file(const fs::path& path) {
  Scene scene;
  if (is_mesh_file(path)) {
    MeshWithMaterials part = load_mesh(path);
    const Bounds bounds = bounds_of(part.mesh);
    scene = {"", std::move(part.mesh), std::move(part.materials), derived_lights(bounds),
             derived_camera(bounds)};
  } else {
    try {
      scene = parse_scene(read_file(path), [&path](std::string_view name) {
        return load_named_mesh(path.parent_path(), name);
      });
    } catch (const SceneError& error) {
      throw SceneError(fmt::format("scene file {}: {}", in_quotes(path.native()), error.what()));
    }
  }
  scene.name = path.stem().string();
  return scene;
}

/// A scene of ours whose meshes are not ours to ship.
template <const char* Name>
Scene make_real() {
  Scene scene = load_scene_file(fs::path(IRT_SCENE_FILES) / (std::string(Name) + ".json"));
  scene.name = "real-" + std::string(Name);
  return scene;
}
constexpr char bunny[] = "bunny";
constexpr char office[] = "office";
constexpr char conference[] = "conference";

std::string all_names() {
  std::string names;
  for (const auto entries : {built_in_scenes(), real_scenes()}) {
    for (const SceneEntry& entry : entries) {
      names += (names.empty() ? "" : ", ") + std::string(entry.name);
    }
  }
  return names;
}

}  // namespace

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

std::span<const SceneEntry> real_scenes() {
  static constexpr SceneEntry entries[] = {
      {"real-bunny", "69,463 triangles: the Stanford bunny (69,451) beside a mirror box",
       make_real<bunny>},
      {"real-office", "22,428 triangles: Greg Ward's office", make_real<office>},
      {"real-conference", "331,179 triangles: Ward's and Grynberg's conference room",
       make_real<conference>},
  };
  return entries;
}

std::filesystem::path scene_data_folder() {
  if (const char* folder = std::getenv("IRT_SCENES"); folder != nullptr && *folder != '\0') {
    return folder;
  }
  return fs::path(IRT_SCENE_DATA);
}

Scene load_scene(std::string_view name_or_path) {
  for (const auto entries : {built_in_scenes(), real_scenes()}) {
    for (const SceneEntry& entry : entries) {
      if (entry.name == name_or_path) return entry.make();
    }
  }
  const fs::path path(name_or_path);
  if (path.extension() != ".json" && !is_mesh_file(path)) {
    throw SceneError(
        fmt::format("scene {} is unknown; give a .json, .ply or .obj file, or one of {}",
                    in_quotes(name_or_path), all_names()));
  }
  try {
    return load_scene_file(path);
  } catch (const std::bad_alloc&) {
    throw SceneError(fmt::format("scene {} does not fit into memory", in_quotes(name_or_path)));
  }
}

}  // namespace irt
