/// Where a ray meets a box, and which of a triangle's crossings count: the scalar reference. How a
/// line crosses a triangle is the business of kernels-inl.hpp.
///
/// A hit is a pure function of the ray and the triangle's corners, and every structure gives the
/// same bits as a test of all triangles. The argument, which every traversal relies on:
///
///  1. `slab` computes (bound - origin) * inverse per axis. `inverse` is finite and not zero, so no
///     NaN can arise; IEEE subtraction and multiplication round monotonically; so a bound further
///     out gives an entry no later and an exit no earlier. Maximum, minimum and the widening of the
///     exit are monotone too. Hence the interval of a box contains that of any box inside it.
///  2. A triangle's distance is clamped into the interval of its own padded box, and a triangle
///     whose own interval is empty is not met. So a hit's distance lies in the interval of every
///     box around the triangle: no such box can be found empty.
///  3. A box is skipped only where its entry lies beyond the best distance so far, so no triangle
///     that is nearer or as near is skipped; of equal distances the lowest index wins. The answer
///     is the least (distance, index) of all hits, whatever the tree and whatever the order.
///
/// Coordinates of about 1e-12 to 1e12 keep their full precision. Beyond that products overflow or
/// underflow: hits may be lost, but never differ between structures.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "renderer/scene/vec3.hpp"
#include "renderer/tracing/rays.hpp"

namespace irt {

/// An axis-aligned box; the default holds nothing and grows from there.
struct Box {
  Vec3 lo{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
          std::numeric_limits<float>::infinity()};
  Vec3 hi{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()};

  void grow(const Box& other) {
    lo = min(lo, other.lo);
    hi = max(hi, other.hi);
  }
  void grow(Vec3 point) {
    lo = min(lo, point);
    hi = max(hi, point);
  }
  /// Half of the surface; 0 for the empty box. Only ever compared, so half is enough.
  [[nodiscard]] float half_area() const {
    if (!(lo.x <= hi.x)) return 0;
    const Vec3 d = hi - lo;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

/// By how much of the largest coordinate a triangle's box is padded.
inline constexpr float box_pad = 0x1p-22f;
/// By which factor the exit of a slab interval is widened.
inline constexpr float exit_widening = 1.0f + 0x1p-21f;

struct Triangle {
  Vec3 a, b, c;
};

/// The box that `triangle` is held to be in. It is padded by two to four units in the last place of
/// the largest coordinate, so that a ray in the plane of a face is inside and not on it.
inline Box padded_bounds(const Triangle& triangle) {
  Box box;
  box.grow(triangle.a);
  box.grow(triangle.b);
  box.grow(triangle.c);
  const Vec3 far = max(-box.lo, box.hi);
  const float largest = std::fmax(far.x, std::fmax(far.y, far.z));
  const float pad = largest * box_pad;
  return {box.lo - Vec3{pad, pad, pad}, box.hi + Vec3{pad, pad, pad}};
}

/// What traversal wants to know of a ray.
struct TraversalRay {
  Vec3 origin;
  Vec3 direction;
  Vec3 inverse;  ///< 1 / direction, never infinite: see `finite_inverse`
  float limit;   ///< the largest distance that counts as a hit; negative where none does

  explicit TraversalRay(const Ray& ray);
};

/// 1 / d, or the largest float with the sign of `d` where that is infinite.
inline float finite_inverse(float d) {
  const float inverse = 1.0f / d;
  return std::fabs(inverse) <= std::numeric_limits<float>::max()
             ? inverse
             : std::copysign(std::numeric_limits<float>::max(), d);
}

/// The largest float below `t_max`; -1 where that leaves no positive distance.
inline float last_below(float t_max) {
  return t_max > std::numeric_limits<float>::denorm_min()
             ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(t_max) - 1)
             : -1.0f;
}

inline TraversalRay::TraversalRay(const Ray& ray)
    : origin(ray.origin),
      direction(ray.direction),
      inverse{finite_inverse(ray.direction.x), finite_inverse(ray.direction.y),
              finite_inverse(ray.direction.z)},
      limit(last_below(ray.t_max)) {
  // A ray with a NaN or an infinity meets nothing. Such a component times zero is a NaN.
  const Vec3 zero = (origin * 0.0f) + (direction * 0.0f);
  if (!(zero.x + zero.y + zero.z == 0)) limit = -1;
}

/// The distances between which a ray is inside a box; empty where `entry > exit`.
struct Interval {
  float entry;  ///< not negative
  float exit;

  /// Whether a hit at or before `limit` is possible in here.
  [[nodiscard]] bool reaches(float limit) const { return entry <= exit && entry <= limit; }
};

/// The part of `ray` inside `box` (Kay and Kajiya 1986). The exit is widened by four units in the
/// last place, more than three roundings can lose (Ize 2013), so that a ray through an edge that
/// two triangles share is inside both boxes.
inline Interval slab(const Box& box, const TraversalRay& ray) {
  const Vec3 t0 = (box.lo - ray.origin) * ray.inverse;
  const Vec3 t1 = (box.hi - ray.origin) * ray.inverse;
  const Vec3 near = min(t0, t1);
  const Vec3 far = max(t0, t1);
  const Vec3 entry = max(Vec3{near.x, near.y, near.z}, Vec3{});
  const float first = entry.x > entry.y ? entry.x : entry.y;
  const float last = far.x < far.y ? far.x : far.y;
  return {first > entry.z ? first : entry.z, (last < far.z ? last : far.z) * exit_widening};
}

/// Makes `hit` on triangle `index` the `best` one where it is nearer, or as near with a lower
/// index. `own` is the interval of the triangle's padded box.
inline void meet(std::uint32_t index, Hit hit, const Interval& own, Hit& best) {
  if (!own.reaches(best.t)) return;
  // The order of comparisons sends a NaN to the exit, a place as good as any in the box.
  hit.t = hit.t < own.entry ? own.entry : hit.t < own.exit ? hit.t : own.exit;
  if (!(hit.t > 0)) return;
  if (hit.t < best.t || (hit.t == best.t && index < best.triangle)) {
    best = {hit.t, hit.u, hit.v, index};
  }
}

/// The state before the first test: nothing is hit, and whatever is nearer than the ray's end wins.
inline Hit no_hit(const TraversalRay& ray) {
  return {ray.limit, 0, 0, no_triangle};
}

}  // namespace irt
