/// The rays of a camera through the pixels of a picture.
#pragma once

#include <cstdint>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/rays.hpp"

namespace irt {

/// A place in a pixel, in [0, 1) each way.
struct InPixel {
  float x = 0.5f, y = 0.5f;
};

/// Where sample number `sample` of `count` goes through a pixel: Hammersley's points, which are
/// spread evenly and the same in every pixel. A single one goes through the centre.
inline InPixel sample_place(std::uint32_t sample, std::uint32_t count) {
  const float half = 0.5f / static_cast<float>(count);
  float mirrored = 0;  // the binary digits of `sample` behind the point, the lowest first
  float digit = 0.5f;
  for (std::uint32_t rest = sample; rest != 0; rest >>= 1, digit *= 0.5f) {
    if ((rest & 1u) != 0) mirrored += digit;
  }
  return {static_cast<float>(sample) / static_cast<float>(count) + half, mirrored + half};
}

/// Alike on every machine.
class PrimaryRays {
 public:
  PrimaryRays(const Camera& camera, std::uint32_t width, std::uint32_t height);

  /// Through pixel (x, y), counted from the top left: through its centre or, with `within`, that
  /// far from its left and upper edge, in pixels. Its length is not 1.
  Ray through(std::uint32_t x, std::uint32_t y, InPixel within = {}) const {
    const float across = (static_cast<float>(x) + within.x) * step_ - half_width_;
    const float down = (static_cast<float>(y) + within.y) * step_ - half_height_;
    return {eye_, forward_ + right_ * across - up_ * down};
  }

 private:
  Vec3 eye_, forward_, right_, up_;
  float half_width_, half_height_, step_;
};

}  // namespace irt
