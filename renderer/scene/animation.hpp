/// Scenes that move: where the vertices of a mesh are in each frame.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "renderer/scene/scene.hpp"

namespace irt {

/// Frames after which an animation begins anew.
inline constexpr std::uint32_t animation_period = 120;

/// Moves the vertices of the mesh that it was made for; triangles and materials stay. A frame's
/// pose depends on its number only, and has the same bits on every machine (nothing but +, -, *
/// and / makes it).
class Animation {
 public:
  Animation() = default;
  Animation(const Animation&) = delete;
  Animation& operator=(const Animation&) = delete;
  virtual ~Animation() = default;

  /// Puts `mesh` into the pose of frame `frame`. Frame 0 is the mesh as it was made, up to
  /// rounding.
  virtual void pose(std::uint32_t frame, Mesh& mesh) const = 0;
};

/// An animation by name, as the tools see it. What it makes keeps a copy of the vertices.
struct AnimationEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Animation> (*make)(const Mesh& mesh);
};

/// All animations. They suit any mesh.
std::span<const AnimationEntry> animations();

}  // namespace irt
