#include "renderer/scene/readers/obj.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include "renderer/scene/readers/derive.hpp"
#include "renderer/scene/readers/input.hpp"

namespace irt {
namespace {

Vec3 clamped(const tinyobj::real_t (&colour)[3]) {
  // A NaN fails every comparison and becomes 0.
  const auto clamp = [](float value) { return value > 0 ? std::min(value, 1.0f) : 0.0f; };
  return {clamp(colour[0]), clamp(colour[1]), clamp(colour[2])};
}

/// The vertex that one corner, such as `7`, `7/2`, `7//3` or `-1/1/1`, refers to.
std::uint32_t to_corner(std::string_view word, std::size_t vertices) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const auto count = static_cast<std::int64_t>(vertices);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    throw SceneError(fmt::format("the corner {} does not start with an index", in_quotes(word)));
  }
  if (error != std::errc{} || index == 0 || index > count || index < -count) {
    throw SceneError(fmt::format("the corner {} is out of range; {} vertices stand before it",
                                 in_quotes(word), count));
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

/// A material's name: the rest of a line, which may hold blanks.
std::string to_name(std::string_view rest) {
  const std::size_t begin = rest.find_first_not_of(" \t");
  if (begin == rest.npos) return {};
  return std::string(rest.substr(begin, rest.find_last_not_of(" \t\r") + 1 - begin));
}

/// Takes an OBJ apart, line by line.
class ObjParser {
 public:
  explicit ObjParser(const MaterialLibrary& library) : library_(library) {
    result_.materials.push_back(default_material());
  }

  void line(std::string_view text) {
    const std::string_view key = next_word(text);
    if (key == "v") {
      vertex(text);
    } else if (key == "f") {
      face(text);
    } else if (key == "usemtl") {
      const auto known = by_name_.find(to_name(text));
      material_ = known == by_name_.end() ? 0 : known->second;
    } else if (key == "mtllib") {
      for (auto file = next_word(text); !file.empty(); file = next_word(text)) add_library(file);
    }
  }

  MeshWithMaterials finish() {
    check_not_empty(result_.mesh);
    return std::move(result_);
  }

 private:
  void vertex(std::string_view text) {
    double position[3];
    for (double& value : position) value = to_number(next_word(text), "a coordinate");
    add_checked_vertex(result_.mesh, position[0], position[1], position[2]);
  }

  void face(std::string_view text) {
    corners_.clear();
    for (auto word = next_word(text); !word.empty(); word = next_word(text)) {
      if (word.starts_with('#')) break;
      corners_.push_back(to_corner(word, result_.mesh.vertices.size()));
    }
    if (corners_.size() < 3) {
      throw SceneError(fmt::format("a face has {} corners; it needs at least 3", corners_.size()));
    }
    add_fan(result_.mesh, corners_, material_);
  }

  void add_library(std::string_view file) {
    // A file that names one library a thousand times is not to read it a thousand times.
    if (!libraries_.insert(std::string(file)).second) return;
    for (Material& material : parse_mtl(library_(file))) {
      const auto index = static_cast<std::uint32_t>(result_.materials.size());
      if (by_name_.emplace(material.name, index).second) {
        result_.materials.push_back(std::move(material));
      }
    }
  }

  const MaterialLibrary& library_;
  MeshWithMaterials result_;
  std::map<std::string, std::uint32_t> by_name_;
  std::set<std::string> libraries_;
  std::vector<std::uint32_t> corners_;
  std::uint32_t material_ = 0;
};

}  // namespace

std::vector<Material> parse_mtl(std::string_view text) {
  // tinyobjloader takes some 2 kB for each.
  constexpr std::size_t most = 65'536;
  std::size_t count = 0;
  for (auto at = text.find("newmtl"); at != text.npos; at = text.find("newmtl", at + 1)) {
    if (++count > most) throw SceneError(fmt::format("a library has over {} materials", most));
  }
  std::istringstream stream{std::string(text)};
  std::map<std::string, int> by_name;
  std::vector<tinyobj::material_t> read;
  std::string warnings;
  std::string errors;
  tinyobj::LoadMtl(&by_name, &read, &stream, &warnings, &errors);
  std::vector<Material> materials;
  for (const tinyobj::material_t& m : read) {
    const bool reflects = m.illum != 1 && m.illum != 2;
    const std::string name = to_name(m.name);
    if (name.empty()) continue;
    materials.push_back({name, clamped(m.diffuse), reflects ? clamped(m.specular) : Vec3{}});
  }
  return materials;
}

MeshWithMaterials parse_obj(std::string_view text, const MaterialLibrary& library) {
  ObjParser parser(library);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = next_line(text);
    try {
      parser.line(line);
    } catch (const SceneError& error) {
      throw SceneError(fmt::format("line {}: {}", number, error.what()));
    }
  }
  return parser.finish();
}

}  // namespace irt
