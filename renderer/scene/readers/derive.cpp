#include "renderer/scene/readers/derive.hpp"

namespace irt {
namespace {

/// Half the diagonal; 1 where all vertices are one point.
float radius_of(const Bounds& bounds) {
  const float half = 0.5f * length(bounds.hi - bounds.lo);
  return half > 0 ? half : 1;
}

Vec3 centre_of(const Bounds& bounds) {
  return (bounds.lo + bounds.hi) * 0.5f;
}

}  // namespace

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds{mesh.corner(0, 0), mesh.corner(0, 0)};
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      bounds.lo = min(bounds.lo, mesh.vertices[index]);
      bounds.hi = max(bounds.hi, mesh.vertices[index]);
    }
  }
  return bounds;
}

Material default_material() {
  return {"default", {0.7f, 0.7f, 0.7f}, {0.08f, 0.08f, 0.08f}};
}

Camera derived_camera(const Bounds& bounds) {
  const Vec3 centre = centre_of(bounds);
  // At 45 degrees a ball fills the height from 1 / sin(22.5 degrees) = 2.61 radii away.
  return {centre + Vec3{0, 0.35f, 2.65f} * radius_of(bounds), centre, {0, 1, 0}, 45};
}

std::vector<PointLight> derived_lights(const Bounds& bounds) {
  const Vec3 centre = centre_of(bounds);
  const float radius = radius_of(bounds);
  return {{centre + Vec3{-1.8f, 1.8f, 2.2f} * radius, {0.5f, 0.5f, 0.5f}},
          {centre + Vec3{2.2f, 1.0f, 2.0f} * radius, {0.3f, 0.3f, 0.3f}},
          {centre + Vec3{0, 3.0f, 0} * radius, {0.25f, 0.25f, 0.25f}},
          {centre + Vec3{-2.0f, 0.2f, 0.5f} * radius, {0.15f, 0.15f, 0.15f}}};
}

}  // namespace irt
