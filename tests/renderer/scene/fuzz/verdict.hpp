/// What a reader may answer to any input: a sound mesh, or a refusal of one short line.
#pragma once

#include <clocale>
#include <cstdlib>
#include <cwchar>
#include <string_view>

#include "renderer/scene/scene.hpp"
#include "renderer/scene/scene_error.hpp"

namespace irt::fuzz {

inline void demand(bool holds) {
  if (!holds) std::abort();
}

inline void demand_sound(const Mesh& mesh, std::size_t materials) {
  demand(!mesh.triangles.empty());
  demand(mesh.material.size() == mesh.triangles.size());
  for (const Vec3 v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) demand(v[axis] >= -1.0001e12f && v[axis] <= 1.0001e12f);
  }
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) demand(index < mesh.vertices.size());
  }
  for (const std::uint32_t index : mesh.material) demand(index < materials);
}

/// Characters in UTF-8, none of which controls a terminal.
inline void demand_printable(std::string_view text) {
  static const bool utf8 = std::setlocale(LC_CTYPE, "C.UTF-8") != nullptr;
  demand(utf8);
  std::mbstate_t state{};
  while (!text.empty()) {
    wchar_t character = 0;
    const std::size_t size = std::mbrtowc(&character, text.data(), text.size(), &state);
    demand(size >= 1 && size <= text.size());
    demand(character >= L' ' && (character < 0x7F || character > 0x9F));
    text.remove_prefix(size);
  }
}

/// Calls `read`, and demands that what it throws is a `SceneError` as a user should see it.
template <class Read>
int verdict(Read read) {
  try {
    read();
  } catch (const SceneError& error) {
    const std::string_view message = error.what();
    demand(!message.empty() && message.size() < 600);
    demand_printable(message);
  }
  return 0;
}

inline std::string_view text_of(const unsigned char* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace irt::fuzz
