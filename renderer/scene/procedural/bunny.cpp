#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "renderer/scene/procedural/shapes.hpp"
#include "renderer/scene/procedural/stand_ins.hpp"
#include "renderer/scene/procedural/surface_nets.hpp"

namespace irt {
namespace {

/// An ellipsoid along the axes.
struct Ellipsoid {
  constexpr Ellipsoid(Vec3 c, Vec3 r)
      : centre(c), inverse_radius{1 / r.x, 1 / r.y, 1 / r.z}, thinnest(r.y) {}

  /// Roughly the distance: exact on the surface.
  float operator()(Vec3 p) const {
    const Vec3 a = (p - centre) * inverse_radius;
    const float k = length(a);
    const float slope = length(a * inverse_radius);
    return slope > 1e-6f ? k * (k - 1) / slope : -thinnest;
  }

  Vec3 centre;
  Vec3 inverse_radius;
  float thinnest;
};

/// Half an ear: a tube from `a` to `b` whose radius goes from `radius_a` to `radius_b`, flattened
/// from front to back.
struct EarPart {
  /// Roughly the distance: exact on the surface.
  float operator()(Vec3 p) const {
    constexpr Vec3 forwards{-0.6f, 0, 0.8f};
    const Vec3 axis = b - a;
    const float s = std::clamp(dot(p - a, axis) / dot(axis, axis), 0.0f, 1.0f);
    Vec3 q = p - a - axis * s;
    q = q + forwards * (0.8f * dot(q, forwards));
    return (length(q) - radius_a - (radius_b - radius_a) * s) * 0.8f;
  }

  Vec3 a, b;
  float radius_a, radius_b;
};

/// The union of two fields, rounded where they meet within `k` of each other.
float blend(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * k * 0.25f;
}

float body(Vec3 p) {
  static constexpr Ellipsoid trunk({0.6f, 7.2f, 0}, {4.6f, 3.9f, 3.7f});
  static constexpr Ellipsoid haunch({2.4f, 6.3f, 1.9f}, {3.2f, 3.1f, 2.4f});
  static constexpr Ellipsoid chest({-3.1f, 7.3f, 0}, {2.7f, 3.5f, 2.9f});
  static constexpr Ellipsoid hind_foot({1.0f, 4.0f, 3.3f}, {2.7f, 0.9f, 1.05f});
  static constexpr Ellipsoid fore_foot({-4.2f, 4.0f, 1.5f}, {1.7f, 0.85f, 0.95f});
  static constexpr Ellipsoid fore_leg({-3.9f, 5.2f, 1.6f}, {0.9f, 2.0f, 0.9f});
  static constexpr Ellipsoid tail({5.6f, 5.9f, 0.2f}, {1.35f, 1.3f, 1.25f});
  const Vec3 side{p.x, p.y, std::abs(p.z)};
  float f = blend(trunk(p), haunch(side), 0.8f);
  f = blend(f, chest(p), 1.6f);
  f = blend(f, hind_foot(side), 0.5f);
  f = blend(f, fore_foot(side), 0.6f);
  f = blend(f, fore_leg(side), 0.9f);
  return blend(f, tail(p), 0.7f);
}

float head(Vec3 p) {
  static constexpr Ellipsoid skull({-5.2f, 12.1f, 0.4f}, {2.35f, 2.05f, 1.95f});
  static constexpr Ellipsoid snout({-7.0f, 11.4f, 0.5f}, {1.35f, 1.05f, 1.2f});
  static constexpr Ellipsoid cheek({-6.5f, 11.1f, 1.0f}, {0.95f, 0.8f, 0.75f});
  static constexpr Ellipsoid socket({-6.7f, 12.75f, 1.5f}, {0.62f, 0.5f, 0.5f});
  static constexpr Ellipsoid eye({-6.5f, 12.7f, 1.3f}, {0.4f, 0.34f, 0.42f});
  const Vec3 face{p.x, p.y, std::abs(p.z - 0.45f)};
  float f = blend(skull(p), snout(p), 1.0f);
  f = blend(f, cheek(face), 0.5f);
  f = -blend(-f, socket(face), 0.4f);
  return blend(f, eye(face), 0.4f);
}

float ears(Vec3 p) {
  static constexpr EarPart parts[] = {{{-4.9f, 13.7f, 1.3f}, {-5.9f, 16.2f, 1.9f}, 0.75f, 1.0f},
                                      {{-5.9f, 16.2f, 1.9f}, {-6.5f, 18.6f, 2.1f}, 1.0f, 0.42f},
                                      {{-4.2f, 13.7f, -0.3f}, {-2.5f, 15.8f, -0.7f}, 0.75f, 1.0f},
                                      {{-2.5f, 15.8f, -0.7f}, {-0.8f, 17.5f, -1.1f}, 1.0f, 0.42f}};
  float f = parts[0](p);
  for (int i = 1; i < 4; ++i) f = blend(f, parts[i](p), 0.8f);
  return f;
}

/// A part where `p` is near the ball that holds it, else the distance to that ball: less work, and
/// the same surface, as no blend reaches that far.
template <class Part>
float within(Part part, Vec3 p, Vec3 centre, float radius) {
  const float to_ball = length(p - centre) - radius;
  return to_ball > 2.5f ? to_ball : part(p);
}

/// The animal, in hundredths of a unit: it looks to -x, sits on y = 3.3, and +z is its left.
float animal(Vec3 p) {
  float f = within(body, p, {0.4f, 6.3f, 0}, 7.0f);
  f = blend(f, within(head, p, {-5.6f, 12.0f, 0.4f}, 3.0f), 1.5f);
  f = blend(f, within(ears, p, {-4.0f, 16.0f, 0.5f}, 4.6f), 0.5f);
  return std::max(f, 3.3f - p.y);
}

float animal_in_units(Vec3 p) {
  return animal(p * 100.0f) * 0.01f;
}

/// A hash of a lattice point in [-1, 1], from integers alone.
float lattice(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
                    static_cast<std::uint32_t>(y) * 0xd8163841u ^
                    static_cast<std::uint32_t>(z) * 0xcb1ab31fu;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return static_cast<float>(h >> 8) * (2.0f / 16'777'215.0f) - 1.0f;
}

/// Smooth noise in [-1, 1] with features of size 1.
float noise(Vec3 p) {
  const int x = static_cast<int>(std::floor(p.x));
  const int y = static_cast<int>(std::floor(p.y));
  const int z = static_cast<int>(std::floor(p.z));
  float weight[3][2];
  for (int axis = 0; axis < 3; ++axis) {
    const float t = p[axis] - std::floor(p[axis]);
    weight[axis][1] = t * t * (3 - 2 * t);
    weight[axis][0] = 1 - weight[axis][1];
  }
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1;
    const int j = corner >> 1 & 1;
    const int k = corner >> 2 & 1;
    sum += weight[0][i] * weight[1][j] * weight[2][k] * lattice(x + i, y + j, z + k);
  }
  return sum;
}

/// Tufts of fur: three octaves, at most 0.7 mm on an animal of 150 mm.
Vec3 with_fur(Vec3 p, float h) {
  const float height =
      0.00038f * noise(p * 110.0f) + 0.0002f * noise(p * 260.0f) + 0.00012f * noise(p * 600.0f);
  return p + field_normal(animal_in_units, p, h) * height;
}

/// The quads as triangles, exactly `bunny_triangles` - 13 of them: those nearest to the face are
/// cut into four around their middle, the others into two, so that the tessellation is uneven.
void add_animal(Mesh& mesh, const QuadMesh& quads, float cell) {
  constexpr std::size_t wanted = bunny_triangles - 13;
  const std::size_t in_four = (wanted - 2 * quads.quads.size()) / 2;
  std::vector<std::pair<float, std::size_t>> by_distance;
  for (std::size_t i = 0; i < quads.quads.size(); ++i) {
    const Vec3 from_face = quads.vertices[quads.quads[i][0]] - Vec3{-0.06f, 0.125f, 0.015f};
    by_distance.emplace_back(dot(from_face, from_face), i);
  }
  std::ranges::nth_element(by_distance, by_distance.begin() + static_cast<std::ptrdiff_t>(in_four));
  std::vector<bool> cut_in_four(quads.quads.size());
  for (std::size_t i = 0; i < in_four; ++i) cut_in_four[by_distance[i].second] = true;

  for (const Vec3 vertex : quads.vertices) add_vertex(mesh, with_fur(vertex, cell));
  for (std::size_t i = 0; i < quads.quads.size(); ++i) {
    const auto& [a, b, c, d] = quads.quads[i];
    if (cut_in_four[i]) {
      const auto& v = quads.vertices;
      const Vec3 middle = onto_surface(animal_in_units, (v[a] + v[b] + v[c] + v[d]) * 0.25f, cell);
      const std::uint32_t m = add_vertex(mesh, with_fur(middle, cell));
      add_triangle(mesh, a, b, m, 0);
      add_triangle(mesh, b, c, m, 0);
      add_triangle(mesh, c, d, m, 0);
      add_triangle(mesh, d, a, m, 0);
    } else {
      add_triangle(mesh, a, b, c, 0);
      add_triangle(mesh, a, c, d, 0);
    }
  }
}

}  // namespace

Scene make_bunny() {
  Scene scene;
  scene.name = "bunny";
  scene.materials = {{"clay", {0.78f, 0.66f, 0.53f}, {0.04f, 0.04f, 0.04f}},
                     {"mirror", {0.03f, 0.03f, 0.035f}, {0.82f, 0.84f, 0.86f}}};
  constexpr float cell = 0.00142f;
  const Grid grid{{-0.092f, 0.028f, -0.055f}, cell, {120, 116, 80}};
  Mesh& mesh = scene.mesh;
  add_animal(mesh, surface_nets(animal_in_units, grid), cell);
  const TriangleIndices first = mesh.triangles.front();
  add_triangle(mesh, first[0], first[1], first[2], 0);

  Vec3 lo = mesh.vertices.front();
  Vec3 hi = lo;
  for (const Vec3 vertex : mesh.vertices) {
    lo = min(lo, vertex);
    hi = max(hi, vertex);
  }
  add_box(mesh, {lo.x - 0.05f, lo.y, lo.z - 0.06f}, {hi.x + 0.05f, hi.y + 0.05f, lo.z - 0.05f}, 1);
  scene.lights = {{{-0.16f, 0.26f, 0.22f}, {0.62f, 0.6f, 0.56f}},
                  {{0.2f, 0.2f, 0.24f}, {0.26f, 0.28f, 0.34f}},
                  {{-0.02f, 0.4f, 0.02f}, {0.3f, 0.3f, 0.3f}},
                  {{-0.2f, 0.08f, 0.05f}, {0.14f, 0.12f, 0.1f}}};
  scene.camera = {{-0.02f, 0.12f, 0.28f}, {-0.02f, 0.105f, 0}, {0, 1, 0}, 45};
  return scene;
}

}  // namespace irt
