#include "renderer/scene/readers/ply.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <utility>

#include "renderer/scene/readers/input.hpp"

namespace irt {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is decoded for x86 and ARM");

enum class Format { ascii, little_endian, big_endian };

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t size_of(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

constexpr bool is_integer(Type type) {
  return type < Type::float32;
}

struct Property {
  std::string_view name;
  Type type = Type::float32;    ///< of the value, or of a list's items
  std::optional<Type> count{};  ///< a list's: the type of its length
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

Type to_type(std::string_view name) {
  constexpr std::string_view names[][2] = {
      {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
      {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
  for (std::size_t i = 0; i < std::size(names); ++i) {
    if (name == names[i][0] || name == names[i][1]) return static_cast<Type>(i);
  }
  throw SceneError(
      fmt::format("header: {} is no PLY type, such as float or uchar", in_quotes(name)));
}

Property to_property(std::string_view& line) {
  Property property;
  std::string_view type = next_word(line);
  if (type == "list") {
    property.count = to_type(next_word(line));
    if (!is_integer(*property.count)) {
      throw SceneError("header: a list's length has a floating-point type; it is an integer");
    }
    type = next_word(line);
  }
  property.type = to_type(type);
  property.name = next_word(line);
  return property;
}

Format to_format(std::string_view name) {
  if (name == "ascii") return Format::ascii;
  if (name == "binary_little_endian") return Format::little_endian;
  if (name == "binary_big_endian") return Format::big_endian;
  throw SceneError(fmt::format(
      "header: the format is {}; it is ascii, binary_little_endian or binary_big_endian",
      in_quotes(name)));
}

std::uint64_t to_count(std::string_view word, std::string_view element) {
  const double count = to_number(word, fmt::format("header: the count of {}", in_quotes(element)));
  if (!(count >= 0 && count < 0x1p53)) {
    throw SceneError(fmt::format("header: the count of {} is {}; it is 0 or more",
                                 in_quotes(element), in_quotes(word)));
  }
  return static_cast<std::uint64_t>(count);
}

/// Reads the header off the front of `bytes`.
Header parse_header(std::string_view& bytes) {
  if (next_line(bytes) != "ply") {
    throw SceneError("is no PLY file: its first line is not 'ply'");
  }
  Header header;
  bool has_format = false;
  while (!bytes.empty()) {
    std::string_view line = next_line(bytes);
    const std::string_view key = next_word(line);
    if (key == "end_header") {
      if (!has_format) throw SceneError("header: there is no line 'format ...'");
      return header;
    }
    if (key == "format") {
      header.format = to_format(next_word(line));
      has_format = true;
    } else if (key == "element") {
      Element element;
      element.name = next_word(line);
      element.count = to_count(next_word(line), element.name);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) {
        throw SceneError("header: a property stands before any element");
      }
      header.elements.back().properties.push_back(to_property(line));
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      throw SceneError(fmt::format("header: {} is no PLY keyword", in_quotes(key)));
    }
  }
  throw SceneError("header: it is cut off; there is no line 'end_header'");
}

/// The values behind the header, one after the other.
class Body {
 public:
  Body(std::string_view bytes, Format format) : bytes_(bytes), format_(format) {}

  double next(Type type) { return format_ == Format::ascii ? next_text() : next_binary(type); }

  /// The fewest bytes that a value of `type` takes.
  [[nodiscard]] std::size_t least_size(Type type) const {
    return format_ == Format::ascii ? 1 : size_of(type);
  }

  [[nodiscard]] std::size_t remaining() const { return bytes_.size(); }

 private:
  double next_text() {
    constexpr std::string_view space = " \t\r\n\v\f";
    const std::size_t begin = bytes_.find_first_not_of(space);
    if (begin == bytes_.npos) truncated();
    bytes_.remove_prefix(begin);
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(space));
    bytes_.remove_prefix(word.size());
    return to_number(word, "a value");
  }

  double next_binary(Type type) {
    const std::size_t size = size_of(type);
    if (bytes_.size() < size) truncated();
    unsigned char raw[8];
    std::memcpy(raw, bytes_.data(), size);
    bytes_.remove_prefix(size);
    if (format_ == Format::big_endian) std::reverse(raw, raw + size);
    switch (type) {
      case Type::int8:
        return decode<std::int8_t>(raw);
      case Type::uint8:
        return decode<std::uint8_t>(raw);
      case Type::int16:
        return decode<std::int16_t>(raw);
      case Type::uint16:
        return decode<std::uint16_t>(raw);
      case Type::int32:
        return decode<std::int32_t>(raw);
      case Type::uint32:
        return decode<std::uint32_t>(raw);
      case Type::float32:
        return decode<float>(raw);
      case Type::float64:
        return decode<double>(raw);
    }
    return 0;
  }

  template <class T>
  static double decode(const unsigned char* raw) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }

  [[noreturn]] static void truncated() { throw SceneError("the data ends too early"); }

  std::string_view bytes_;
  Format format_;
};

/// A list's length, which the rest of the file can hold.
std::size_t list_length(Body& body, const Property& list) {
  const double length = body.next(*list.count);
  const std::size_t most = body.remaining() / body.least_size(list.type);
  if (!(length >= 0 && length <= static_cast<double>(most))) {
    throw SceneError(fmt::format("a list has the length {}; the rest of the file holds {} values",
                                 length, most));
  }
  // ASCII files can hold fractions.
  if (length != static_cast<double>(static_cast<std::size_t>(length))) {
    throw SceneError(fmt::format("a list has the length {}; it is a whole number", length));
  }
  return static_cast<std::size_t>(length);
}

void skip(Body& body, const Property& property) {
  std::size_t values = property.count ? list_length(body, property) : 1;
  while (values-- > 0) body.next(property.type);
}

/// The fewest bytes that a row of `element` takes; the values of lists may be none.
std::size_t least_row_size(const Body& body, const Element& element) {
  std::size_t size = 0;
  for (const Property& p : element.properties) size += body.least_size(p.count.value_or(p.type));
  return size;
}

/// Throws unless the rest of the file can hold as many rows as the header claims.
void check_count(const Body& body, const Element& element) {
  const std::size_t row = least_row_size(body, element);
  if (row > 0 && element.count > body.remaining() / row) {
    throw SceneError(fmt::format("the header claims {} of {}, more than the file holds",
                                 element.count, in_quotes(element.name)));
  }
}

void read_vertices(Body& body, const Element& element, Mesh& mesh) {
  constexpr std::string_view axes[] = {"x", "y", "z"};
  for (const std::string_view axis : axes) {
    const auto is_axis = [axis](const Property& p) { return p.name == axis && !p.count; };
    if (std::ranges::count_if(element.properties, is_axis) != 1) {
      throw SceneError(
          fmt::format("header: vertices need one property '{}' of a scalar type", axis));
    }
  }
  mesh.vertices.reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    double position[3] = {};
    for (const Property& property : element.properties) {
      const auto* axis = std::ranges::find(axes, property.name);
      if (axis != std::end(axes)) {
        position[axis - axes] = body.next(property.type);
      } else {
        skip(body, property);
      }
    }
    add_checked_vertex(mesh, position[0], position[1], position[2]);
  }
}

bool is_corner_list(const Property& property) {
  return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void read_corners(Body& body, const Property& list, std::uint64_t face, Mesh& mesh,
                  std::vector<std::uint32_t>& corners) {
  const std::size_t length = list_length(body, list);
  if (length < 3) {
    throw SceneError(fmt::format("face {} has {} corners; it needs at least 3", face, length));
  }
  corners.clear();
  for (std::size_t i = 0; i < length; ++i) {
    const double index = body.next(list.type);
    if (!(index >= 0 && index < static_cast<double>(mesh.vertices.size())) ||
        index != static_cast<double>(static_cast<std::uint32_t>(index))) {
      throw SceneError(fmt::format("face {} has the vertex index {}; there are {} vertices, from 0",
                                   face, index, mesh.vertices.size()));
    }
    corners.push_back(static_cast<std::uint32_t>(index));
  }
  add_fan(mesh, corners, 0);
}

void read_faces(Body& body, const Element& element, Mesh& mesh) {
  if (std::ranges::count_if(element.properties, is_corner_list) != 1) {
    throw SceneError("header: faces need one list 'vertex_indices'");
  }
  // Rows may be empty lists as far as `check_count` knows; a triangle takes four values.
  const std::uint64_t room = std::min<std::uint64_t>(element.count, body.remaining() / 4);
  mesh.triangles.reserve(room);
  mesh.material.reserve(room);
  std::vector<std::uint32_t> corners;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    for (const Property& property : element.properties) {
      if (!is_corner_list(property)) {
        skip(body, property);
      } else if (!is_integer(property.type)) {
        throw SceneError("header: vertex indices have a floating-point type; it is an integer");
      } else {
        read_corners(body, property, row, mesh, corners);
      }
    }
  }
}

}  // namespace

Mesh parse_ply(std::string_view bytes) {
  const Header header = parse_header(bytes);
  Body body(bytes, header.format);
  Mesh mesh;
  bool has_vertices = false;
  for (const Element& element : header.elements) {
    check_count(body, element);
    if (element.name == "vertex" && !std::exchange(has_vertices, true)) {
      read_vertices(body, element, mesh);
    } else if (element.name == "face" && mesh.triangles.empty()) {
      if (!has_vertices) throw SceneError("header: faces stand before the vertices");
      read_faces(body, element, mesh);
    } else if (!element.properties.empty()) {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        for (const Property& property : element.properties) skip(body, property);
      }
    }
  }
  check_not_empty(mesh);
  return mesh;
}

}  // namespace irt
