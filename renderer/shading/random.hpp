/// Random numbers that belong to a place and not to a moment: the same whatever thread draws them.
#pragma once

#include <cmath>
#include <cstdint>

#include "renderer/scene/vec3.hpp"

namespace irt {

/// The numbers of one ray: those of its pixel, sample and bounce. Two rays that differ in any of
/// them have streams that share nothing.
///
/// SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators"), its
/// state begun from the three numbers side by side. Alike on every machine: nothing but integers,
/// additions, products and square roots.
class RayRandom {
 public:
  /// `bounce` is less than 2^10, `sample` less than 2^22.
  RayRandom(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce)
      : state_(mixed(std::uint64_t{pixel} << 32 | std::uint64_t{sample} << 10 | bounce)) {}

  /// Uniform in [0, 1).
  float uniform() {
    return static_cast<float>(mixed(state_ += 0x9e37'79b9'7f4a'7c15u) >> 40) * 0x1p-24f;
  }

  /// Uniform in [0, `count`), which is less than 2^24.
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(uniform() * static_cast<float>(count));
  }

  /// A direction above the surface with the unit normal `normal`, by the cosine to it; of length 1
  /// up to rounding. The tip is drawn from the unit sphere that touches the surface at its foot.
  Vec3 cosine_weighted(Vec3 normal) {
    while (true) {
      const float x = 2 * uniform() - 1, y = 2 * uniform() - 1, z = 2 * uniform() - 1;
      const Vec3 in_cube{x, y, z};
      const float size = dot(in_cube, in_cube);
      if (size > 1 || size < 1e-4f) continue;  // outside of the ball, or too short to stretch
      const Vec3 direction = normal + in_cube * (1 / std::sqrt(size));
      if (dot(direction, normal) > 1e-4f) return normalize(direction);
    }
  }

 private:
  static constexpr std::uint64_t mixed(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58'476d'1ce4'e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d0'49bb'1331'11ebu;
    return bits ^ (bits >> 31);
  }

  std::uint64_t state_;
};

}  // namespace irt
