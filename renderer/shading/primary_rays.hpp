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

/// Pixels are visited in tiles of 16 x 16, and within a tile along a Z-order curve, so that any
/// aligned run of 4, 8, 16 or 256 rays covers a compact block: 2 x 2, 4 x 2, 4 x 4, the whole tile.
inline constexpr std::uint32_t tile_side = 16;

/// The even bits of an 8-bit Morton number: the column in a tile. Of half the number: the row.
constexpr std::uint32_t even_bits(std::uint32_t morton) {
  return (morton & 1u) | (morton >> 1 & 2u) | (morton >> 2 & 4u) | (morton >> 3 & 8u);
}

/// Alike on every machine.
class PrimaryRays {
 public:
  PrimaryRays(const Camera& camera, std::uint32_t width, std::uint32_t height);

  /// Appends to `rays`, which has room, those through `count` pixels of the tile whose upper left
  /// pixel is (left, top), from place `first` of the curve on, each with `weight` in every channel.
  /// `count` is a multiple of 16, and the pixels are all in the picture.
  void add_run(std::uint32_t left, std::uint32_t top, std::uint32_t first, std::uint32_t count,
               InPixel within, float weight, Rays& rays) const;

  /// Through pixel (x, y), counted from the top left: through its centre or, with `within`, that
  /// far from its left and upper edge, in pixels. Its length is not 1.
  [[nodiscard]] Ray through(std::uint32_t x, std::uint32_t y, InPixel within = {}) const {
    const float across = (static_cast<float>(x) + within.x) * view_.step - view_.half_width;
    const float down = (static_cast<float>(y) + within.y) * view_.step - view_.half_height;
    return {view_.eye, view_.forward + view_.right * across - view_.up * down};
  }

  /// Where the eye is, what it looks along, the picture's right and up, and half of the picture's
  /// size and a pixel's at distance 1.
  struct View {
    Vec3 eye, forward, right, up;
    float half_width, half_height, step;
    std::uint32_t width;  ///< of the picture, in pixels
  };

 private:
  View view_;
};

}  // namespace irt
