#include "renderer/scene/animation.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace irt {
namespace {

/// A place on the unit circle.
struct OnCircle {
  float cosine, sine;
};

/// Once around while `turns` grows by 1. Each quarter is drawn by the rational parametrisation of
/// the circle: not at an even pace, but without a library's sine, whose last bit differs from one
/// machine to the other.
OnCircle on_circle(float turns) {
  const float in_quarters = (turns - static_cast<float>(static_cast<int>(turns))) * 4;
  const int quarter = static_cast<int>(in_quarters);
  const float t = in_quarters - static_cast<float>(quarter);
  const float cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
  switch (quarter) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

float turns_at(std::uint32_t frame) {
  return static_cast<float>(frame % animation_period) / float{animation_period};
}

struct Extent {
  Vec3 low, high;

  [[nodiscard]] Vec3 middle() const { return (low + high) * 0.5f; }
  [[nodiscard]] float size() const { return length(high - low); }
};

Extent extent_of(const std::vector<Vec3>& vertices) {
  Extent extent{vertices.front(), vertices.front()};
  for (const Vec3 vertex : vertices) {
    extent.low = min(extent.low, vertex);
    extent.high = max(extent.high, vertex);
  }
  return extent;
}

/// Vertices that triangles join to each other.
struct Object {
  std::vector<std::uint32_t> vertices;
  std::size_t triangles = 0;
  Extent extent{};
};

/// The connected parts of a mesh, in the order of their first vertices.
std::vector<Object> objects_of(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    // The lower index leads, so that objects come in the order of their first vertices.
    for (const std::uint32_t other : {b, c}) {
      const auto [first, second] = std::minmax({root(a), root(other)});
      parent[second] = first;
    }
  }
  std::vector<Object> objects;
  std::vector<std::size_t> object_at(mesh.vertices.size());
  for (std::uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    const Vec3 point = mesh.vertices[vertex];
    if (root(vertex) == vertex) {
      object_at[vertex] = objects.size();
      objects.push_back({{}, 0, {point, point}});
    }
    Object& object = objects[object_at[root(vertex)]];
    object.vertices.push_back(vertex);
    object.extent = {min(object.extent.low, point), max(object.extent.high, point)};
  }
  for (const auto& triangle : mesh.triangles) ++objects[object_at[root(triangle[0])]].triangles;
  return objects;
}

/// The object with the most triangles turns on the spot.
class Turn final : public Animation {
 public:
  explicit Turn(const Mesh& mesh) : rest_(mesh.vertices) {
    for (Object& object : objects_of(mesh)) {
      if (object.triangles > turning_.triangles) turning_ = std::move(object);
    }
  }

  void pose(std::uint32_t frame, Mesh& mesh) const override {
    const auto [cosine, sine] = on_circle(turns_at(frame));
    const Vec3 axis = turning_.extent.middle();
    for (const std::uint32_t vertex : turning_.vertices) {
      const Vec3 from_axis = rest_[vertex] - axis;
      mesh.vertices[vertex] = {axis.x + from_axis.x * cosine + from_axis.z * sine, rest_[vertex].y,
                               axis.z + from_axis.z * cosine - from_axis.x * sine};
    }
  }

 private:
  std::vector<Vec3> rest_;
  Object turning_;
};

/// A wave runs through everything, up and down along x.
class Wave final : public Animation {
 public:
  explicit Wave(const Mesh& mesh) : rest_(mesh.vertices), extent_(extent_of(mesh.vertices)) {}

  void pose(std::uint32_t frame, Mesh& mesh) const override {
    constexpr float height = 0.03f, waves = 1.5f;
    const float now = turns_at(frame), wide = extent_.high.x - extent_.low.x;
    const float per_x = wide > 0 ? waves / wide : 0;
    for (std::size_t vertex = 0; vertex < rest_.size(); ++vertex) {
      const Vec3 point = rest_[vertex];
      const float along = (point.x - extent_.low.x) * per_x;
      // From what it is in frame 0, so that the animation starts with the mesh at rest.
      const float rise = on_circle(now + along).sine - on_circle(along).sine;
      mesh.vertices[vertex].y = point.y + height * extent_.size() * rise;
    }
  }

 private:
  std::vector<Vec3> rest_;
  Extent extent_;
};

/// Small objects circle each at its own pace, so that neighbours part; where there is none, all do.
class Swarm final : public Animation {
 public:
  explicit Swarm(const Mesh& mesh) : rest_(mesh.vertices) {
    constexpr float small = 0.25f, reach = 0.1f;
    const float size = extent_of(mesh.vertices).size();
    radius_ = reach * size;
    std::vector<Object> all = objects_of(mesh);
    const auto large = std::stable_partition(all.begin(), all.end(), [&](const Object& object) {
      return object.extent.size() < small * size;
    });
    if (large != all.begin()) all.erase(large, all.end());
    moving_ = std::move(all);
  }

  void pose(std::uint32_t frame, Mesh& mesh) const override {
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      // Once, twice or three times around in a period, one way or the other.
      const auto rounds = static_cast<float>(1 + i % 3);
      const auto [cosine, sine] = on_circle(rounds * turns_at(frame));
      const float way = i / 3 % 2 == 0 ? radius_ : -radius_;
      const Vec3 moved{(1 - cosine) * way, 0, sine * way};
      for (const std::uint32_t vertex : moving_[i].vertices) {
        mesh.vertices[vertex] = rest_[vertex] + moved;
      }
    }
  }

 private:
  std::vector<Vec3> rest_;
  std::vector<Object> moving_;
  float radius_;
};

template <class A>
std::unique_ptr<Animation> make(const Mesh& mesh) {
  return std::make_unique<A>(mesh);
}

constexpr AnimationEntry entries[] = {
    {"turn", "the object with the most triangles turns on the spot", make<Turn>},
    {"wave", "a wave runs through everything", make<Wave>},
    {"swarm", "small objects circle, and part from their neighbours", make<Swarm>},
};

}  // namespace

std::span<const AnimationEntry> animations() {
  return entries;
}

}  // namespace irt
