#include "renderer/bvh/goncalves.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "renderer/bvh/sah_cost.hpp"
#include "renderer/bvh/triangles.hpp"

namespace irt {
namespace {

constexpr int most_bins = 16;
/// No split by cost below this depth. Halving adds at most 32 levels for 2^32 triangles.
constexpr int cost_depth = 60;
constexpr int most_depth = cost_depth + 32;

/// Triangles whose lower (or upper) edge lies in one stretch of an axis.
struct Bin {
  Box box;
  std::uint32_t count = 0;

  void add(const Bin& other) {
    box.grow(other.box);
    count += other.count;
  }
};
using Bins = std::array<Bin, most_bins>;

/// Left of the split are the triangles whose edge falls into a bin below `plane`.
struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;  ///< -1: none was found
  bool upper_edge = false;
  int plane = 0;
  int bins = 0;
  float origin = 0, scale = 0;

  [[nodiscard]] int bin_of(const Box& box) const {
    const float edge = upper_edge ? box.hi[axis] : box.lo[axis];
    return std::min(bins - 1, static_cast<int>((edge - origin) * scale));
  }
};

/// Lowers `best` to the cheapest plane between `bins`.
void sweep(const Bins& bins, const Split& along, Split& best) {
  std::array<float, most_bins> right_cost{};
  Bin right;
  for (int plane = along.bins - 1; plane > 0; --plane) {
    right.add(bins[static_cast<std::size_t>(plane)]);
    right_cost[static_cast<std::size_t>(plane)] =
        right.box.half_area() * static_cast<float>(right.count);
  }
  Bin left;
  for (int plane = 1; plane < along.bins; ++plane) {
    left.add(bins[static_cast<std::size_t>(plane - 1)]);
    if (left.count == 0 || left.count == right.count + bins[0].count) continue;
    const float cost = left.box.half_area() * static_cast<float>(left.count) +
                       right_cost[static_cast<std::size_t>(plane)];
    if (cost < best.cost) {
      best = along;
      best.cost = cost;
      best.plane = plane;
    }
  }
}

}  // namespace

struct Goncalves::Builder {
  std::vector<Box> boxes;            ///< per triangle
  std::vector<std::uint32_t> order;  ///< of triangles; each node owns a stretch
  std::vector<Node>& nodes;

  struct Open {
    Node* node;
    std::uint32_t begin, end;
    int depth;
  };

  [[nodiscard]] Split find_split(const Open& open) const {
    Split best;
    const std::uint32_t count = open.end - open.begin;
    for (int axis = 0; axis < 3; ++axis) {
      Split along;
      along.axis = axis;
      along.bins = static_cast<int>(std::min<std::uint32_t>(most_bins, count + 2));
      along.origin = open.node->box.lo[axis];
      along.scale = static_cast<float>(along.bins) / (open.node->box.hi[axis] - along.origin);
      if (!(along.scale <= std::numeric_limits<float>::max() && along.scale > 0)) continue;
      for (const bool upper_edge : {false, true}) {
        along.upper_edge = upper_edge;
        Bins bins{};
        for (std::uint32_t i = open.begin; i < open.end; ++i) {
          const Box& box = boxes[order[i]];
          Bin& bin = bins[static_cast<std::size_t>(along.bin_of(box))];
          bin.box.grow(box);
          ++bin.count;
        }
        sweep(bins, along, best);
      }
    }
    return best;
  }

  std::uint32_t partition(const Open& open) {
    const Split split = open.depth < cost_depth ? find_split(open) : Split{};
    if (split.axis < 0) return open.begin + (open.end - open.begin) / 2;
    const auto first = order.begin() + open.begin;
    const auto middle = std::partition(
        first, order.begin() + open.end,
        [&](std::uint32_t triangle) { return split.bin_of(boxes[triangle]) < split.plane; });
    return open.begin + static_cast<std::uint32_t>(middle - first);
  }

  Node* add_node(std::uint32_t begin, std::uint32_t end) {
    Node& node = nodes.emplace_back();
    for (std::uint32_t i = begin; i < end; ++i) node.box.grow(boxes[order[i]]);
    return &node;
  }

  void build() {
    const auto count = static_cast<std::uint32_t>(order.size());
    std::vector<Open> stack{{add_node(0, count), 0, count, 0}};
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      if (open.end - open.begin == 1) {
        open.node->triangle = order[open.begin];
        continue;
      }
      const std::uint32_t middle = partition(open);
      Node* const child1 = add_node(open.begin, middle);
      Node* const child2 = add_node(middle, open.end);
      open.node->child1 = child1;
      open.node->child2 = child2;
      stack.push_back({child2, middle, open.end, open.depth + 1});
      stack.push_back({child1, open.begin, middle, open.depth + 1});
    }
  }
};

Goncalves::Goncalves(const Mesh& mesh, const AcceleratorOptions& options)
    : SingleRayAccelerator("goncalves", options), triangles_(corners(mesh)) {
  if (triangles_.empty()) return;
  nodes_.reserve(2 * triangles_.size() - 1);
  Builder builder{{}, std::vector<std::uint32_t>(triangles_.size()), nodes_};
  builder.boxes.reserve(triangles_.size());
  for (const Triangle& triangle : triangles_) builder.boxes.push_back(padded_bounds(triangle));
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  builder.build();
  sah_cost_ = expected_boxes(nodes_);
}

bool Goncalves::refit(const Mesh& mesh, Executor& /*executor*/) {
  triangles_ = corners(mesh);
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {  // children before parents
    if (node->child1 == nullptr) {
      node->box = padded_bounds(triangles_[node->triangle]);
    } else {
      node->box = node->child1->box;
      node->box.grow(node->child2->box);
    }
  }
  sah_cost_ = expected_boxes(nodes_);
  return true;
}

template <class Kernel, bool any, class Probe>
Hit Goncalves::trace(const KernelRay<Kernel>& ray, Probe& probe) const {
  struct Pending {
    const Node* node;
    Interval inside;
  };
  std::array<Pending, most_depth + 1> stack;
  std::size_t pending = 0;
  Hit best = no_hit(ray);
  if (nodes_.empty()) return best;

  Pending at{nodes_.data(), slab(nodes_.front().box, ray)};
  if (!at.inside.reaches(best.t)) return best;
  while (true) {
    if (at.node->child1 == nullptr) {
      probe.test_begins();
      ray.meet(triangles_[at.node->triangle], at.node->triangle, at.inside, best);
      probe.test_ends();
      if (any && best.triangle != no_triangle) return best;
    } else {
      Pending near{at.node->child1, slab(at.node->child1->box, ray)};
      Pending far{at.node->child2, slab(at.node->child2->box, ray)};
      const bool near_reached = near.inside.reaches(best.t);
      const bool far_reached = far.inside.reaches(best.t);
      if (near_reached && far_reached) {
        if (far.inside.entry < near.inside.entry) std::swap(near, far);
        stack[pending++] = far;
        at = near;
        continue;
      }
      if (near_reached || far_reached) {
        at = near_reached ? near : far;
        continue;
      }
    }
    do {
      if (pending == 0) return best;
      at = stack[--pending];
    } while (!(at.inside.entry <= best.t));
  }
}

template class SingleRayAccelerator<Goncalves>;

}  // namespace irt
