#include "renderer/bvh/wald.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/bvh/sah_cost.hpp"
#include "renderer/bvh/triangles.hpp"

namespace irt {
namespace {

/// No split by cost below this depth; halving adds at most 32 levels.
constexpr int cost_depth = wald_most_depth - 32;
/// Larger lists are split even where a leaf would be cheaper: coincident triangles.
constexpr std::uint32_t most_in_leaf = 16;
/// Cost of a step down, where a triangle test costs 1.
constexpr float step_cost = 1.0f;

struct Reference {
  Box box;
  Vec3 centre;  ///< twice the centre
  std::uint32_t index;
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;
  std::uint32_t left = 0;  ///< triangles on the left
};

void sort_along(int axis, std::span<Reference> references) {
  std::ranges::sort(references, [axis](const Reference& a, const Reference& b) {
    return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.index < b.index;
  });
}

/// Prices every partition of `references`, which are sorted along `axis`.
void sweep(int axis, std::span<const Reference> references, std::vector<float>& right_area,
           Split& best) {
  const std::size_t count = references.size();
  Box right;
  for (std::size_t i = count - 1; i > 0; --i) {
    right.grow(references[i].box);
    right_area[i] = right.half_area();
  }
  Box left;
  for (std::size_t i = 1; i < count; ++i) {
    left.grow(references[i - 1].box);
    const float cost =
        left.half_area() * static_cast<float>(i) + right_area[i] * static_cast<float>(count - i);
    if (cost < best.cost) best = {cost, axis, static_cast<std::uint32_t>(i)};
  }
}

Box bounds_of(std::span<const Reference> references) {
  Box box;
  for (const Reference& reference : references) box.grow(reference.box);
  return box;
}

/// Null for single rays.
const WaldPackets* packets_for(const AcceleratorOptions& options) {
  if (options.width <= 1) return nullptr;
  return wald_packets(options.isa, options.kernel, options.width);
}

/// What concerns packets is checked by `packets_for`.
AcceleratorOptions single_ray_part(AcceleratorOptions options) {
  if (options.width > 1) {
    options.width = 1;
    options.isa = {};
  }
  return options;
}

}  // namespace

struct Wald::Builder {
  std::vector<Reference> references;
  std::vector<float> right_area;
  std::vector<WaldNode>& nodes;

  struct Open {
    std::uint32_t node;
    std::uint32_t begin, end;
    int depth;
  };

  std::span<Reference> list(std::uint32_t begin, std::uint32_t end) {
    return {references.data() + begin, end - begin};
  }

  /// How many triangles go left, after sorting them; 0 makes a leaf.
  std::uint32_t split(const Open& open) {
    const std::span<Reference> all = list(open.begin, open.end);
    const auto count = static_cast<std::uint32_t>(all.size());
    if (count == 1) return 0;
    if (open.depth >= cost_depth) return count <= most_in_leaf ? 0 : count / 2;
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      sort_along(axis, all);
      sweep(axis, all, right_area, best);
    }
    const float area = nodes[open.node].box().half_area();
    const bool worth_it = area * step_cost + best.cost < area * static_cast<float>(count);
    if (count <= most_in_leaf && !worth_it) return 0;
    if (best.axis < 0) return count / 2;
    if (best.axis != 2) sort_along(best.axis, all);
    return best.left;
  }

  std::uint32_t add_node(std::uint32_t begin, std::uint32_t end) {
    const Box box = bounds_of(list(begin, end));
    nodes.push_back({box.lo, 0, box.hi, 0, 0, 0});
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }

  /// Notes along which axis the children's centres are furthest apart, and which is lower.
  void order_children(WaldNode& parent) const {
    const WaldNode& first = nodes[parent.first];
    const WaldNode& second = nodes[parent.first + 1];
    const Vec3 apart = (second.box_min + second.box_max) - (first.box_min + first.box_max);
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
      if (std::fabs(apart[other]) > std::fabs(apart[axis])) axis = other;
    }
    parent.axis = static_cast<std::uint8_t>(axis);
    parent.low_child = apart[axis] < 0 ? 1 : 0;
  }

  void build() {
    const auto count = static_cast<std::uint32_t>(references.size());
    std::vector<Open> stack{{add_node(0, count), 0, count, 0}};
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      const std::uint32_t left = split(open);
      if (left == 0) {
        nodes[open.node].first = open.begin;
        nodes[open.node].triangles = static_cast<std::uint16_t>(open.end - open.begin);
        continue;
      }
      const std::uint32_t middle = open.begin + left;
      const std::uint32_t first = add_node(open.begin, middle);
      const std::uint32_t second = add_node(middle, open.end);
      nodes[open.node].first = first;
      order_children(nodes[open.node]);
      stack.push_back({second, middle, open.end, open.depth + 1});
      stack.push_back({first, open.begin, middle, open.depth + 1});
    }
  }
};

Wald::Wald(const Mesh& mesh, const AcceleratorOptions& options)
    : SingleRayAccelerator("wald", single_ray_part(options)), packets_(packets_for(options)) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  if (count == 0) return;
  nodes_.reserve(count);
  Builder builder{{}, std::vector<float>(count), nodes_};
  builder.references.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Box box = padded_bounds(triangle_of(mesh, i));
    builder.references.push_back({box, box.lo + box.hi, i});
  }
  builder.build();
  nodes_.shrink_to_fit();
  triangles_.reserve(count);
  for (const Reference& reference : builder.references) {
    triangles_.push_back({triangle_of(mesh, reference.index), reference.index});
  }
  sah_cost_ = expected_boxes(nodes_);
}

bool Wald::refit(const Mesh& mesh, Executor& /*executor*/) {
  for (WaldTriangle& triangle : triangles_) triangle.corners = triangle_of(mesh, triangle.index);
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {  // children before parents
    Box box;
    if (node->triangles > 0) {
      for (std::uint32_t i = node->first; i < node->first + node->triangles; ++i) {
        box.grow(padded_bounds(triangles_[i].corners));
      }
    } else {
      box = nodes_[node->first].box();
      box.grow(nodes_[node->first + 1].box());
    }
    node->box_min = box.lo;
    node->box_max = box.hi;
  }
  sah_cost_ = expected_boxes(nodes_);
  return true;
}

void Wald::closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const {
  if (packets_ == nullptr || rays.singly)
    return SingleRayAccelerator::closest_hit(rays, hits, profile);
  with_profile(profile, [&](auto& probe) {
    packets_->closest({nodes_, triangles_}, rays, hits, tick_probe(probe));
  });
}

void Wald::any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
                   TraceProfile* profile) const {
  if (packets_ == nullptr || rays.singly)
    return SingleRayAccelerator::any_hit(rays, occluded, profile);
  with_profile(profile, [&](auto& probe) {
    packets_->any({nodes_, triangles_}, rays, occluded, tick_probe(probe));
  });
}

template <class Kernel, bool any, class Probe>
Hit Wald::trace(const KernelRay<Kernel>& ray, Probe& probe) const {
  std::array<std::uint32_t, wald_most_depth + 2> stack;
  std::size_t pending = 0;
  Hit best = no_hit(ray);
  if (nodes_.empty()) return best;
  const std::array<std::uint32_t, 3> falling{ray.direction.x < 0, ray.direction.y < 0,
                                             ray.direction.z < 0};
  stack[pending++] = 0;
  while (pending > 0) {
    const WaldNode& node = nodes_[stack[--pending]];
    if (!slab(node.box(), ray).reaches(best.t)) continue;
    if (node.triangles > 0) {
      probe.test_begins();
      for (std::uint32_t i = node.first; i < node.first + node.triangles; ++i) {
        ray.meet(triangles_[i].corners, triangles_[i].index, best);
        if (any && best.triangle != no_triangle) break;
      }
      probe.test_ends();
      if (any && best.triangle != no_triangle) return best;
    } else {
      const std::uint32_t near = node.low_child ^ falling[node.axis];
      stack[pending++] = node.first + (near ^ 1);
      stack[pending++] = node.first + near;
    }
  }
  return best;
}

template class SingleRayAccelerator<Wald>;

}  // namespace irt
