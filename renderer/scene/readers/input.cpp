#include "renderer/scene/readers/input.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <vector>

namespace irt {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

/// One less than the index that stands for "none", and as many as 32 bits can count.
constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max() - 1;

/// How many bytes the character at the front of `text` has in UTF-8; 0 if they are none, or one
/// that controls instead of being printed.
std::size_t printable(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first >= ' ' && first <= '~' ? 1 : 0;
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  const unsigned char second = byte(1);
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool no_character = (first == 0xed && second > 0x9f) || (first == 0xf4 && second > 0x8f);
  const bool controls = first == 0xc2 && second < 0xa0;
  return overlong || no_character || controls ? 0 : size;
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  constexpr std::uintmax_t limit = std::uintmax_t{4} << 30;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw SceneError("there is no such file");
  if (fs::is_directory(status)) throw SceneError("is a directory; give a file in it");
  if (!fs::is_regular_file(status)) throw SceneError("is no regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw SceneError("cannot be read: " + error.message());
  if (size > limit) throw SceneError(fmt::format("has {} bytes; at most 4 GiB are read", size));
  std::ifstream file(path, std::ios::binary);
  std::string bytes(size, '\0');
  if (!file || !file.read(bytes.data(), static_cast<std::streamsize>(size))) {
    throw SceneError("cannot be read; look at its permissions");
  }
  return bytes;
}

std::string in_quotes(std::string_view text) {
  std::vector<std::string> shown;
  while (!text.empty()) {
    const std::size_t size = printable(text);
    shown.emplace_back(size == 0 ? "?" : text.substr(0, size));
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  // What a path ends with names the file.
  constexpr std::size_t most_shown = 60, at_front = 20;
  if (shown.size() > most_shown) {
    const auto front = shown.begin() + at_front;
    shown.erase(front, shown.end() - (most_shown - at_front));
    shown.insert(shown.begin() + at_front, "...");
  }
  return fmt::format("'{}'", fmt::join(shown, ""));
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == text.npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view next_word(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  text.remove_prefix(begin == text.npos ? text.size() : begin);
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

double to_number(std::string_view word, std::string_view what) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range && end == word.data() + word.size()) {
    throw SceneError(fmt::format("{} is {}, beyond what a number can hold", what, in_quotes(word)));
  }
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw SceneError(fmt::format("{} is {}, not a number", what, in_quotes(word)));
  }
  return value;
}

void add_checked_vertex(Mesh& mesh, double x, double y, double z) {
  for (const double value : {x, y, z}) {
    if (!(std::abs(value) <= largest_coordinate)) {
      throw SceneError(fmt::format("vertex {} has the coordinate {}; they are finite, up to +-{:g}",
                                   mesh.vertices.size(), value, largest_coordinate));
    }
  }
  if (mesh.vertices.size() == most) throw SceneError("there are more than 2^32 - 2 vertices");
  mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
}

void add_fan(Mesh& mesh, const std::vector<std::uint32_t>& corners, std::uint32_t material) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (mesh.triangles.size() == most) throw SceneError("there are more than 2^32 - 2 triangles");
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    mesh.material.push_back(material);
  }
}

void check_not_empty(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw SceneError("has no faces; a scene needs at least one triangle");
}

}  // namespace irt
