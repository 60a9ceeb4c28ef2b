/// Small meshes and bundles of rays for the tests of accelerators.
#pragma once

#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/tracing/intersection.hpp"

namespace irt::test {

/// The same numbers on every machine, which std::uniform_real_distribution does not promise.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float uniform(float lo, float hi) {
    return lo + (hi - lo) * static_cast<float>(engine_() >> 8) * 0x1p-24f;
  }
  Vec3 in_box(Vec3 lo, Vec3 hi) {
    const float x = uniform(lo.x, hi.x), y = uniform(lo.y, hi.y), z = uniform(lo.z, hi.z);
    return {x, y, z};
  }
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(engine_()) % bound; }

 private:
  std::mt19937 engine_;
};

inline void add_triangle(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.material.push_back(0);
}

/// `count` triangles with edges up to `edge` in the unit cube times `scale`.
inline Mesh soup(std::uint32_t count, float edge, float scale = 1, std::uint32_t seed = 1) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 a = random.in_box({0, 0, 0}, {1, 1, 1});
    const Vec3 b = a + random.in_box({-edge, -edge, -edge}, {edge, edge, edge});
    const Vec3 c = a + random.in_box({-edge, -edge, -edge}, {edge, edge, edge});
    add_triangle(mesh, a * scale, b * scale, c * scale);
  }
  return mesh;
}

/// A closed sphere of radius `scale` around the origin: 2 * rings * segments - 2 * segments
/// triangles on shared vertices.
inline Mesh sphere(std::uint32_t rings, std::uint32_t segments, float scale = 1) {
  Mesh mesh;
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    const double theta = std::numbers::pi * ring / rings;
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
      const double phi = 2 * std::numbers::pi * segment / segments;
      mesh.vertices.push_back({scale * static_cast<float>(std::sin(theta) * std::cos(phi)),
                               scale * static_cast<float>(std::cos(theta)),
                               scale * static_cast<float>(std::sin(theta) * std::sin(phi))});
    }
  }
  const auto vertex = [&](std::uint32_t ring, std::uint32_t segment) {
    if (ring == 0 || ring == rings) segment = 0;
    return ring * segments + segment % segments;
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
      const TriangleIndices upper{vertex(ring, segment), vertex(ring, segment + 1),
                                  vertex(ring + 1, segment)};
      const TriangleIndices lower{vertex(ring, segment + 1), vertex(ring + 1, segment + 1),
                                  vertex(ring + 1, segment)};
      if (ring > 0) mesh.triangles.push_back(upper);
      if (ring + 1 < rings) mesh.triangles.push_back(lower);
    }
  }
  mesh.material.assign(mesh.triangles.size(), 0);
  return mesh;
}

inline Box bounds(const Mesh& mesh) {
  Box box;
  for (const Vec3 vertex : mesh.vertices) box.grow(vertex);
  return box;
}

/// `count` rays from in and around the mesh in all directions, every eighth along an axis and every
/// fifth with an end.
inline Rays random_rays(const Mesh& mesh, std::uint32_t count, std::uint32_t seed = 7) {
  Random random(seed);
  const Box box = bounds(mesh);
  const Vec3 margin = (box.hi - box.lo) * 0.25f;
  Rays rays(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Ray ray{random.in_box(box.lo - margin, box.hi + margin),
            random.in_box({-1, -1, -1}, {1, 1, 1})};
    if (i % 8 == 0) {
      ray.direction = {};
      ray.direction[static_cast<int>(i / 8 % 3)] = i / 24 % 2 == 0 ? 1.0f : -1.0f;
      ray.direction[static_cast<int>((i / 8 + 1) % 3)] = i / 48 % 2 == 0 ? 0.0f : -0.0f;
    }
    if (i % 5 == 0) ray.t_max = length(box.hi - box.lo) * random.uniform(0, 1);
    rays.add(ray, {1, 1, 1}, i);
  }
  return rays;
}

inline std::unique_ptr<Accelerator> build(std::string_view name, const Mesh& mesh,
                                          const AcceleratorOptions& options = {}) {
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == name) return entry.build(mesh, options);
  }
  return nullptr;
}

/// The names of all structures but brute force.
inline std::vector<std::string> structure_names() {
  std::vector<std::string> names;
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name != "none") names.emplace_back(entry.name);
  }
  return names;
}

}  // namespace irt::test
