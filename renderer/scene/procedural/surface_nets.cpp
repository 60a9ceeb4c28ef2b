#include "renderer/scene/procedural/surface_nets.hpp"

#include <cstddef>

namespace irt {
namespace {

/// The field at the corners of all cells.
class Samples {
 public:
  Samples(Field field, const Grid& grid) : grid_(grid) {
    for (int axis = 0; axis < 3; ++axis) size_[axis] = grid.size[axis] + 1;
    values_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                   static_cast<std::size_t>(size_[2]));
    for (int z = 0; z < size_[2]; z += block) {
      for (int y = 0; y < size_[1]; y += block) {
        for (int x = 0; x < size_[0]; x += block) sample_block(field, x, y, z);
      }
    }
  }

  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::size_t count() const { return values_.size(); }
  float operator[](std::size_t at) const { return values_[at]; }
  [[nodiscard]] Vec3 position(float x, float y, float z) const {
    return grid_.lo + Vec3{x, y, z} * grid_.cell;
  }

 private:
  static constexpr int block = 4;

  /// Far from the surface one value serves the whole block: only its sign is ever read.
  void sample_block(Field field, int x0, int y0, int z0) {
    const float half = 0.5f * static_cast<float>(block - 1);
    const float middle =
        field(position(static_cast<float>(x0) + half, static_cast<float>(y0) + half,
                       static_cast<float>(z0) + half));
    // Half a block's diagonal, a cell more for the edges that leave it, and the field's own error.
    const bool far = (middle < 0 ? -middle : middle) > 1.5f * (1.7321f * half + 1) * grid_.cell;
    for (int z = z0; z < z0 + block && z < size_[2]; ++z) {
      for (int y = y0; y < y0 + block && y < size_[1]; ++y) {
        for (int x = x0; x < x0 + block && x < size_[0]; ++x) {
          values_[index(x, y, z)] =
              far ? middle
                  : field(position(static_cast<float>(x), static_cast<float>(y),
                                   static_cast<float>(z)));
        }
      }
    }
  }

  Grid grid_;
  int size_[3];
  std::vector<float> values_;
};

constexpr std::uint32_t no_vertex = 0xffff'ffffu;

/// The mean of the points where the surface crosses the twelve edges of the cell.
/// False where it crosses none.
bool cell_vertex(const Samples& samples, int x, int y, int z, Vec3& vertex) {
  float value[8];
  int inside = 0;
  for (int corner = 0; corner < 8; ++corner) {
    value[corner] =
        samples[samples.index(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1))];
    inside += value[corner] < 0;
  }
  if (inside == 0 || inside == 8) return false;
  Vec3 sum{};
  float crossings = 0;
  for (int a = 0; a < 8; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      const int b = a | 1 << axis;
      if (a == b || (value[a] < 0) == (value[b] < 0)) continue;
      Vec3 at{static_cast<float>(a & 1), static_cast<float>(a >> 1 & 1),
              static_cast<float>(a >> 2 & 1)};
      at[axis] = value[a] / (value[a] - value[b]);
      sum = sum + at;
      crossings += 1;
    }
  }
  const Vec3 mean = sum * (1 / crossings);
  vertex = samples.position(static_cast<float>(x) + mean.x, static_cast<float>(y) + mean.y,
                            static_cast<float>(z) + mean.z);
  return true;
}

/// 4 h times the gradient, from the corners of a tetrahedron.
Vec3 gradient(Field field, Vec3 p, float h) {
  const float a = field({p.x + h, p.y - h, p.z - h});
  const float b = field({p.x - h, p.y - h, p.z + h});
  const float c = field({p.x - h, p.y + h, p.z - h});
  const float d = field({p.x + h, p.y + h, p.z + h});
  return {a - b - c + d, -a - b + c + d, -a + b - c + d};
}

}  // namespace

Vec3 field_normal(Field field, Vec3 p, float h) {
  return normalize(gradient(field, p, h));
}

Vec3 onto_surface(Field field, Vec3 p, float h) {
  const Vec3 slope = gradient(field, p, h) * (0.25f / h);
  return p - slope * (field(p) / dot(slope, slope));
}

QuadMesh surface_nets(Field field, const Grid& grid) {
  const Samples samples(field, grid);
  QuadMesh mesh;
  std::vector<std::uint32_t> vertex_of(samples.count(), no_vertex);
  for (int z = 0; z < grid.size[2]; ++z) {
    for (int y = 0; y < grid.size[1]; ++y) {
      for (int x = 0; x < grid.size[0]; ++x) {
        Vec3 vertex;
        if (!cell_vertex(samples, x, y, z, vertex)) continue;
        vertex_of[samples.index(x, y, z)] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(onto_surface(field, vertex, 0.25f * grid.cell));
      }
    }
  }
  for (int z = 1; z < grid.size[2]; ++z) {
    for (int y = 1; y < grid.size[1]; ++y) {
      for (int x = 1; x < grid.size[0]; ++x) {
        const std::size_t here = samples.index(x, y, z);
        const std::size_t step[3] = {1, samples.index(0, 1, 0), samples.index(0, 0, 1)};
        for (int axis = 0; axis < 3; ++axis) {
          const bool inside = samples[here] < 0;
          if (inside == (samples[here + step[axis]] < 0)) continue;
          // The four cells around the edge, counter-clockwise seen from its far end.
          const std::size_t u = step[(axis + 1) % 3];
          const std::size_t v = step[(axis + 2) % 3];
          Quad quad{vertex_of[here - u - v], vertex_of[here - v], vertex_of[here],
                    vertex_of[here - u]};
          if (!inside) std::swap(quad[1], quad[3]);
          mesh.quads.push_back(quad);
        }
      }
    }
  }
  return mesh;
}

}  // namespace irt
