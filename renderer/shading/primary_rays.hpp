/// The rays of a camera through the pixels of a picture.
#pragma once

#include <cstdint>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/rays.hpp"

namespace irt {

/// Alike on every machine.
class PrimaryRays {
 public:
  PrimaryRays(const Camera& camera, std::uint32_t width, std::uint32_t height);

  /// Through the centre of pixel (x, y), counted from the top left. Its length is not 1.
  Ray through(std::uint32_t x, std::uint32_t y) const {
    const float across = (static_cast<float>(x) + 0.5f) * step_ - half_width_;
    const float down = (static_cast<float>(y) + 0.5f) * step_ - half_height_;
    return {eye_, forward_ + right_ * across - up_ * down};
  }

 private:
  Vec3 eye_, forward_, right_, up_;
  float half_width_, half_height_, step_;
};

}  // namespace irt
