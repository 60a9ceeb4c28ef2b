/// What the readers share: files, text and the checks that every mesh passes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "renderer/scene/scene.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt {

/// The whole file. Throws `SceneError` for what is no readable file of at most 4 GiB.
std::string read_file(const std::filesystem::path& path);

/// `text` in quotes, fit for one line: of more than 60 characters the first 20 and the last 40, '?'
/// for bytes that are no UTF-8 and for what does not print.
std::string in_quotes(std::string_view text);

/// Cuts the next line, without its line end, off the front of `text`.
std::string_view next_line(std::string_view& text);

/// Cuts the next word, between blanks, off the front of `text`; empty at the end.
std::string_view next_word(std::string_view& text);

/// The number that is all of `word`. Throws `SceneError`; `what` names the number in the message.
double to_number(std::string_view word, std::string_view what);

/// Coordinates reach to +-1e12: a product of three lengths still fits a float.
inline constexpr double largest_coordinate = 1e12;

/// Appends a vertex. Throws `SceneError` for a coordinate that is no number, infinite or too large.
void add_checked_vertex(Mesh& mesh, double x, double y, double z);

/// A face's corners as a fan of triangles: n - 2 for n corners. The corners are in range.
void add_fan(Mesh& mesh, const std::vector<std::uint32_t>& corners, std::uint32_t material);

/// Throws `SceneError` for a mesh without triangles.
void check_not_empty(const Mesh& mesh);

}  // namespace irt
