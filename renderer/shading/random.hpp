/// Random numbers that belong to a place and not to a moment: the same whatever thread draws them.
#pragma once

#include <cmath>
#include <cstdint>

#include "queues/split_mix.hpp"
#include "renderer/scene/vec3.hpp"

namespace irt {

/// The numbers of one ray: those of its pixel, sample and bounce. Two rays that differ in any of
/// them have streams that share nothing.
///
/// The seed is made of the three numbers side by side. Alike on every machine: nothing but
/// integers, additions, products and square roots.
class RayRandom {
 public:
  /// `bounce` is less than 2^10, `sample` less than 2^22.
  RayRandom(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce)
      : numbers_(
            SplitMix::mixed(std::uint64_t{pixel} << 32 | std::uint64_t{sample} << 10 | bounce)) {}

  /// Uniform in [0, 1).
  float uniform() { return numbers_.uniform(); }

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
  SplitMix numbers_;
};

}  // namespace irt
