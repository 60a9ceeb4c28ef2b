#include "renderer/scene/readers/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "renderer/scene/procedural/shapes.hpp"
#include "renderer/scene/readers/derive.hpp"
#include "renderer/scene/readers/input.hpp"

namespace irt {
namespace {

using nlohmann::json;

/// A value and where in the file it stands, for messages: `lights[2].position`.
struct Node {
  const json& value;
  std::string where;

  Node operator[](const char* key) const {
    return {value.at(key), where.empty() ? key : where + "." + key};
  }
  [[nodiscard]] bool has(const char* key) const { return value.contains(key); }
  [[noreturn]] void fail(std::string_view wanted) const {
    throw SceneError(fmt::format("{} {}", where.empty() ? "the file" : where, wanted));
  }
};

/// Throws unless `node` is an object with no other keys than `allowed`, and with all of `needed`.
void check_keys(const Node& node, std::initializer_list<std::string_view> needed,
                std::initializer_list<std::string_view> optional) {
  if (!node.value.is_object()) node.fail("is to be an object: {...}");
  for (const auto& [key, value] : node.value.items()) {
    if (std::ranges::find(needed, key) == needed.end() &&
        std::ranges::find(optional, key) == optional.end()) {
      node.fail(fmt::format("has the key {}; it may have {}{}{}", in_quotes(key),
                            fmt::join(needed, ", "), needed.size() > 0 ? ", " : "",
                            fmt::join(optional, ", ")));
    }
  }
  for (const std::string_view key : needed) {
    if (!node.value.contains(key)) node.fail(fmt::format("lacks the key '{}'", key));
  }
}

float to_float(const Node& node, double lo, double hi) {
  if (!node.value.is_number()) node.fail("is to be a number");
  const auto number = node.value.get<double>();
  if (!(number >= lo && number <= hi)) {
    node.fail(fmt::format("is {}; it lies between {:g} and {:g}", number, lo, hi));
  }
  return static_cast<float>(number);
}

Vec3 to_vec3(const Node& node, double lo, double hi) {
  if (!node.value.is_array() || node.value.size() != 3)
    node.fail("is to be three numbers: [x, y, z]");
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    result[axis] = to_float({node.value[i], fmt::format("{}[{}]", node.where, i)}, lo, hi);
  }
  return result;
}

Vec3 to_point(const Node& node) {
  return to_vec3(node, -largest_coordinate, largest_coordinate);
}

std::string to_string(const Node& node) {
  if (!node.value.is_string()) node.fail("is to be a string: \"...\"");
  return node.value.get<std::string>();
}

/// Calls `visit` with each item of the list under `key`, if there is one.
template <class Visit>
void for_each(const Node& parent, const char* key, std::size_t most, Visit visit) {
  if (!parent.has(key)) return;
  const Node list = parent[key];
  if (!list.value.is_array()) list.fail("is to be a list: [...]");
  if (list.value.size() > most) {
    list.fail(fmt::format("has {} items; it may have {}", list.value.size(), most));
  }
  for (std::size_t i = 0; i < list.value.size(); ++i) {
    visit(Node{list.value[i], fmt::format("{}[{}]", list.where, i)});
  }
}

/// The two corners of a box, in any order.
Bounds to_bounds(const Node& node) {
  const Vec3 a = to_point(node["lo"]);
  const Vec3 b = to_point(node["hi"]);
  return {min(a, b), max(a, b)};
}

/// Puts a scene together, part by part.
class SceneBuilder {
 public:
  explicit SceneBuilder(const Node& file) : file_(file) {
    check_keys(file_, {}, {"meshes", "boxes", "materials", "regions", "lights", "camera"});
  }

  Scene build(const MeshLoader& load_mesh) {
    materials();
    for_each(file_, "meshes", 1000, [&](const Node& node) { mesh(node, load_mesh); });
    for_each(file_, "boxes", 100'000, [&](const Node& node) {
      check_keys(node, {"lo", "hi", "material"}, {});
      const auto [lo, hi] = to_bounds(node);
      add_box(scene_.mesh, lo, hi, material(node["material"]));
    });
    check_not_empty(scene_.mesh);
    for_each(file_, "regions", 1000, [&](const Node& node) { region(node); });
    const Bounds bounds = bounds_of(scene_.mesh);
    scene_.lights = lights(bounds);
    scene_.camera = camera(bounds);
    return std::move(scene_);
  }

 private:
  void materials() {
    if (!file_.has("materials")) return;
    const Node all = file_["materials"];
    if (!all.value.is_object()) all.fail("is to be an object: {\"name\": {...}}");
    for (const auto& [name, value] : all.value.items()) {
      const Node node{value, "materials." + in_quotes(name)};
      check_keys(node, {}, {"diffuse", "specular"});
      Material material{name, {0.7f, 0.7f, 0.7f}, {}};
      if (node.has("diffuse")) material.diffuse = to_vec3(node["diffuse"], 0, 1);
      if (node.has("specular")) material.specular = to_vec3(node["specular"], 0, 1);
      scene_.materials.push_back(std::move(material));
    }
    named_ = scene_.materials.size();
  }

  /// The index of a material that the file defines.
  [[nodiscard]] std::uint32_t material(const Node& node) const {
    const std::string name = to_string(node);
    const auto index = find(name);
    if (index == named_)
      node.fail(fmt::format("is {}, which 'materials' does not define", in_quotes(name)));
    return index;
  }

  /// The index of the file's material of that name; `named_` if it has none.
  [[nodiscard]] std::uint32_t find(std::string_view name) const {
    const auto named = std::span(scene_.materials).first(named_);
    return static_cast<std::uint32_t>(std::ranges::find(named, name, &Material::name) -
                                      named.begin());
  }

  void mesh(const Node& node, const MeshLoader& load_mesh) {
    const bool only_a_name = node.value.is_string();
    if (!only_a_name) check_keys(node, {"file"}, {"material"});
    const std::string file = to_string(only_a_name ? node : node["file"]);
    MeshWithMaterials part = load_mesh(file);
    const bool one_material = !only_a_name && node.has("material");
    std::vector<std::uint32_t> index_of;
    for (Material& own : part.materials) {
      std::uint32_t index = one_material ? material(node["material"]) : find(own.name);
      if (index == named_) {
        index = static_cast<std::uint32_t>(scene_.materials.size());
        scene_.materials.push_back(std::move(own));
      }
      index_of.push_back(index);
    }
    append(part.mesh, index_of);
  }

  void append(const Mesh& part, const std::vector<std::uint32_t>& material_of) {
    Mesh& mesh = scene_.mesh;
    constexpr std::size_t most = 0xffff'fffe;
    if (mesh.vertices.size() + part.vertices.size() > most ||
        mesh.triangles.size() + part.triangles.size() > most) {
      throw SceneError("the meshes together have more than 2^32 - 2 vertices or triangles");
    }
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
    for (const std::uint32_t index : part.material) mesh.material.push_back(material_of[index]);
  }

  /// Gives a material to the triangles that lie in a box.
  void region(const Node& node) {
    check_keys(node, {"lo", "hi", "material"}, {});
    const auto [lo, hi] = to_bounds(node);
    const std::uint32_t index = material(node["material"]);
    Mesh& mesh = scene_.mesh;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      Vec3 low = lo;
      Vec3 high = hi;
      for (int k = 0; k < 3; ++k) {
        low = min(low, mesh.corner(i, k));
        high = max(high, mesh.corner(i, k));
      }
      if (low == lo && high == hi) mesh.material[i] = index;
    }
  }

  [[nodiscard]] std::vector<PointLight> lights(const Bounds& bounds) const {
    std::vector<PointLight> result;
    for_each(file_, "lights", 64, [&](const Node& node) {
      check_keys(node, {"position"}, {"intensity"});
      PointLight light{to_point(node["position"]), {0.3f, 0.3f, 0.3f}};
      if (node.has("intensity")) light.intensity = to_vec3(node["intensity"], 0, 1000);
      result.push_back(light);
    });
    return result.empty() ? derived_lights(bounds) : result;
  }

  [[nodiscard]] Camera camera(const Bounds& bounds) const {
    if (!file_.has("camera")) return derived_camera(bounds);
    const Node node = file_["camera"];
    check_keys(node, {"eye", "target"}, {"up", "vertical_fov"});
    Camera camera{to_point(node["eye"]), to_point(node["target"]), {0, 1, 0}, 60};
    if (node.has("up")) camera.up = to_vec3(node["up"], -1, 1);
    if (node.has("vertical_fov")) camera.vertical_fov = to_float(node["vertical_fov"], 0.01, 179);
    const Vec3 view = camera.target - camera.eye;
    if (!(length(view) > 0)) node.fail("has its eye at its target; they differ");
    const Vec3 side = cross(normalize(view), camera.up);
    if (!(length(side) > 1e-4f))
      node.fail("looks along its 'up', or 'up' is zero; give another 'up'");
    return camera;
  }

  const Node& file_;
  Scene scene_;
  std::size_t named_ = 0;  ///< the first so many materials are the file's own
};

}  // namespace

Scene parse_scene(std::string_view text, const MeshLoader& load_mesh) {
  json file;
  try {
    file = json::parse(text, nullptr, true, true);
  } catch (const json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte);
    throw SceneError(
        fmt::format("line {}: is no valid JSON", 1 + std::ranges::count(before, '\n')));
  } catch (const json::exception& error) {
    throw SceneError(fmt::format("is no valid JSON: {}", in_quotes(error.what())));
  }
  const Node node{file, ""};
  return SceneBuilder(node).build(load_mesh);
}

}  // namespace irt
