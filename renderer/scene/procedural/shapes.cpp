#include "renderer/scene/procedural/shapes.hpp"

#include <cmath>
#include <utility>

namespace irt {
namespace {

/// Where the next vertex will be.
std::uint32_t next_vertex(const Mesh& mesh) {
  return static_cast<std::uint32_t>(mesh.vertices.size());
}

/// Two triangles, counter-clockwise.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
              std::uint32_t material) {
  add_triangle(mesh, a, b, c, material);
  add_triangle(mesh, a, c, d, material);
}

/// Triangles over a grid of (columns + 1) x (rows + 1) vertices that starts at `first`.
void add_grid(Mesh& mesh, std::uint32_t first, int columns, int rows, std::uint32_t material) {
  const auto stride = static_cast<std::uint32_t>(columns) + 1;
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j) {
    for (std::uint32_t i = 0; i + 1 < stride; ++i) {
      const std::uint32_t at = first + j * stride + i;
      add_quad(mesh, at, at + 1, at + stride + 1, at + stride, material);
    }
  }
}

Vec3 mix(Vec3 a, Vec3 b, float t) {
  return a * (1 - t) + b * t;
}

}  // namespace

std::uint32_t add_vertex(Mesh& mesh, Vec3 position) {
  mesh.vertices.push_back(position);
  return next_vertex(mesh) - 1;
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  std::uint32_t material) {
  mesh.triangles.push_back({a, b, c});
  mesh.material.push_back(material);
}

void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, std::uint32_t material) {
  const std::uint32_t first = next_vertex(mesh);
  for (unsigned corner = 0; corner < 8; ++corner) {
    add_vertex(mesh,
               {corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z});
  }
  constexpr std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& [a, b, c, d] : sides) {
    add_quad(mesh, first + a, first + b, first + c, first + d, material);
  }
}

void add_patch(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d, int across, int along,
               std::uint32_t material) {
  const std::uint32_t first = next_vertex(mesh);
  for (int j = 0; j <= along; ++j) {
    const float t = static_cast<float>(j) / static_cast<float>(along);
    for (int i = 0; i <= across; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(across);
      add_vertex(mesh, mix(mix(a, b, s), mix(d, c, s), t));
    }
  }
  add_grid(mesh, first, across, along, material);
}

void add_cushion(Mesh& mesh, Vec3 lo, Vec3 hi, int n, std::uint32_t material) {
  const Vec3 centre = mix(lo, hi, 0.5f);
  const Vec3 half = (hi - lo) * 0.5f;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const std::uint32_t first = next_vertex(mesh);
      for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = side * (2 * static_cast<float>(i) / static_cast<float>(n) - 1);
          p[(axis + 2) % 3] = 2 * static_cast<float>(j) / static_cast<float>(n) - 1;
          // Half-way from the cube to the ball of the fourth-power norm.
          const Vec3 squared = p * p;
          const float norm = std::sqrt(std::sqrt(dot(squared, squared)));
          add_vertex(mesh, centre + p * half * (1 / norm));
        }
      }
      add_grid(mesh, first, n, n, material);
    }
  }
}

void add_turned(Mesh& mesh, Vec3 origin, std::span<const Ring> profile, int segments,
                std::uint32_t material) {
  const auto around = static_cast<std::uint32_t>(segments);
  const std::uint32_t first = next_vertex(mesh);
  for (const Ring& ring : profile) {
    for (int i = 0; i < segments; ++i) {
      const Turn turn(static_cast<double>(i) / segments);
      add_vertex(mesh, origin + Vec3{ring.radius * turn.cos, ring.height, -ring.radius * turn.sin});
    }
  }
  for (std::uint32_t j = 0; j + 1 < profile.size(); ++j) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t low = first + j * around;
      const std::uint32_t next = (i + 1) % around;
      if (profile[j].radius > 0) {
        add_triangle(mesh, low + i, low + next, low + around + next, material);
      }
      if (profile[j + 1].radius > 0) {
        add_triangle(mesh, low + i, low + around + next, low + around + i, material);
      }
    }
  }
}

void add_ball(Mesh& mesh, Vec3 centre, float radius, int segments, int rings,
              std::uint32_t material) {
  std::vector<Ring> profile;
  for (int i = 0; i <= rings; ++i) {
    const Turn turn(0.5 * i / rings);
    profile.push_back({i == 0 || i == rings ? 0 : radius * turn.sin, -radius * turn.cos});
  }
  add_turned(mesh, centre, profile, segments, material);
}

void add_rod(Mesh& mesh, std::span<const Vec3> path, float radius, int sides,
             std::uint32_t material) {
  const auto around = static_cast<std::uint32_t>(sides);
  const std::size_t last = path.size() - 1;
  const std::uint32_t start = add_vertex(mesh, path[0]);
  const std::uint32_t end = add_vertex(mesh, path[last]);
  const std::uint32_t first = next_vertex(mesh);
  const Vec3 begins = normalize(path[1] - path[0]);
  Vec3 u = std::abs(begins.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  for (std::size_t i = 0; i <= last; ++i) {
    const Vec3 along = normalize(path[i < last ? i + 1 : i] - path[i > 0 ? i - 1 : i]);
    u = normalize(u - along * dot(u, along));
    const Vec3 v = cross(along, u);
    for (int k = 0; k < sides; ++k) {
      const Turn turn(static_cast<double>(k) / sides);
      add_vertex(mesh, path[i] + (u * turn.cos + v * turn.sin) * radius);
    }
  }
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t next = (k + 1) % around;
    add_triangle(mesh, start, first + next, first + k, material);
    for (std::uint32_t i = 0; i < last; ++i) {
      const std::uint32_t ring = first + i * around;
      add_quad(mesh, ring + k, ring + next, ring + around + next, ring + around + k, material);
    }
    const std::uint32_t ring = first + static_cast<std::uint32_t>(last) * around;
    add_triangle(mesh, end, ring + k, ring + next, material);
  }
}

void add_leaf(Mesh& mesh, Vec3 root, Vec3 middle, Vec3 tip, float width, int triangles,
              std::uint32_t material) {
  const Vec3 level = cross(tip - root, {0, 1, 0});
  const Vec3 side = dot(level, level) > 0 ? normalize(level) : Vec3{1, 0, 0};
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  // A strip of n triangles has n + 2 vertices, left and right in turn, and narrows at both ends.
  for (int i = 0; i < triangles + 2; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(triangles + 1);
    const Vec3 spine = mix(mix(root, middle, t), mix(middle, tip, t), t);
    const float half = width * 2 * (t + 0.1f) * (1.1f - t) * (i % 2 == 0 ? -1.0f : 1.0f);
    const std::uint32_t c = add_vertex(mesh, spine + side * half);
    if (i >= 2) {
      if (i % 2 == 0) {
        add_triangle(mesh, a, b, c, material);
      } else {
        add_triangle(mesh, b, a, c, material);
      }
    }
    a = b;
    b = c;
  }
}

Turn::Turn(double turns) {
  const double quarters = 4 * (turns - std::floor(turns));
  const auto nearest = static_cast<int>(std::lround(quarters));
  const double x = (quarters - nearest) * 1.5707963267948966;
  const double xx = x * x;
  double s = x * (1 - xx / 6 * (1 - xx / 20 * (1 - xx / 42 * (1 - xx / 72 * (1 - xx / 110)))));
  double c = 1 - xx / 2 * (1 - xx / 12 * (1 - xx / 30 * (1 - xx / 56 * (1 - xx / 90))));
  for (int i = 0; i < nearest; ++i) s = std::exchange(c, -s);
  cos = static_cast<float>(c);
  sin = static_cast<float>(s);
}

void place(Mesh& mesh, std::size_t first, double turns, Vec3 offset) {
  const Turn turn(turns);
  for (std::size_t i = first; i < mesh.vertices.size(); ++i) {
    const Vec3 p = mesh.vertices[i];
    mesh.vertices[i] =
        Vec3{p.x * turn.cos + p.z * turn.sin, p.y, p.z * turn.cos - p.x * turn.sin} + offset;
  }
}

}  // namespace irt
