/// The surface where a ray has met it, and how to leave it without meeting it again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "renderer/scene/scene.hpp"

namespace irt {

/// A point of a triangle, seen from the side that a ray came from.
struct Surface {
  Vec3 point;
  Vec3 normal;      ///< unit length, towards the side that the ray came from
  float magnitude;  ///< largest coordinate of the triangle, by absolute value

  /// The point lifted off the surface on the side of the normal, far enough that neither a ray that
  /// starts here nor one that comes from `other_end` meets this surface, nor one that coincides
  /// with it.
  ///
  /// The distance follows the rounding errors of the test, which grow with the coordinates that
  /// enter it, and not an absolute epsilon: a scene behaves alike in metres and in millimetres
  /// (Wächter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing
  /// Gems 2019, chapter 6). A triangle test loses some units of 2^-24 of the largest coordinate;
  /// 2^-17 of it leaves room for slender triangles.
  [[nodiscard]] Vec3 lifted(Vec3 other_end) const {
    const float reach =
        std::max({magnitude, std::abs(other_end.x), std::abs(other_end.y), std::abs(other_end.z)});
    return point + normal * (reach * 0x1p-17f);
  }
};

/// The surface of triangle `index` at the barycentric weights `u` and `v`, met by a ray along
/// `incoming`. Nothing where the triangle is so thin that it has no normal.
inline std::optional<Surface> surface_at(const Mesh& mesh, std::uint32_t index, float u, float v,
                                         Vec3 incoming) {
  // In double precision, where products of floats neither overflow nor vanish.
  struct Wide {
    double x, y, z;
  };
  const Vec3 a = mesh.corner(index, 0), b = mesh.corner(index, 1), c = mesh.corner(index, 2);
  const Wide p{double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z};
  const Wide q{double{c.x} - a.x, double{c.y} - a.y, double{c.z} - a.z};
  const Wide n{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
  const double size = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  if (!(size > 0)) return std::nullopt;

  const double towards = n.x * incoming.x + n.y * incoming.y + n.z * incoming.z;
  const double to_unit = (towards > 0 ? -1 : 1) / size;
  float magnitude = 0;
  for (const Vec3 corner : {a, b, c}) {
    magnitude = std::max({magnitude, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  }
  return Surface{
      .point = {static_cast<float>(a.x + u * p.x + v * q.x),
                static_cast<float>(a.y + u * p.y + v * q.y),
                static_cast<float>(a.z + u * p.z + v * q.z)},
      .normal = {static_cast<float>(n.x * to_unit), static_cast<float>(n.y * to_unit),
                 static_cast<float>(n.z * to_unit)},
      .magnitude = magnitude,
  };
}

/// `direction` mirrored at a surface with the unit normal `normal`; the length stays.
inline Vec3 reflect(Vec3 direction, Vec3 normal) {
  return direction - normal * (2 * dot(direction, normal));
}

}  // namespace irt
