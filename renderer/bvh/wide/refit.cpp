#include "renderer/bvh/wide/refit.hpp"

#include <vector>

#include "renderer/bvh/sah_cost.hpp"
#include "renderer/bvh/triangles.hpp"

namespace irt {
namespace {

/// What the part of the tree below a child amounts to: its box, and its cost times the area of the
/// root.
struct Part {
  Box box;
  double cost = 0;
};

class Refit {
 public:
  Refit(WideBvh& bvh, const Mesh& mesh) : bvh_(bvh), mesh_(mesh) {}

  /// All below and including the node `index`. Where the caller has refitted a subtree before,
  /// `done` has it.
  Part node(std::uint32_t index, const std::vector<Part>* done = nullptr) {
    Part whole;
    WideNode& node = bvh_.nodes[index];
    for (int slot = 0; slot < wide_fanout; ++slot) {
      if (!in_use(node, slot)) continue;
      const WideChild child = node.child[slot];
      const Part part = child.is_leaf()   ? leaf(child)
                        : done == nullptr ? this->node(child.node())
                                          : (*done)[static_cast<std::size_t>(slot)];
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[axis][slot] = part.box.lo[axis];
        node.plane[axis + 3][slot] = part.box.hi[axis];
      }
      whole.box.grow(part.box);
      whole.cost += part.cost;
    }
    whole.cost += half_area(whole.box);
    return whole;
  }

  /// Lanes without a child have an empty box, before and after.
  static bool in_use(const WideNode& node, int slot) {
    return node.plane[0][slot] <= node.plane[3][slot];
  }

 private:
  Part leaf(WideChild child) {
    Part part;
    const std::uint32_t blocks = (child.count() + wide_block - 1) / wide_block;
    for (std::uint32_t b = 0; b < blocks; ++b) {
      WideBlock& block = bvh_.blocks[child.first_block() + b];
      for (int lane = 0; lane < wide_block; ++lane) {
        const std::uint32_t index = block.index[lane];
        const Triangle triangle = triangle_of(mesh_, index);
        const float corners[3][3] = {{triangle.a.x, triangle.a.y, triangle.a.z},
                                     {triangle.b.x, triangle.b.y, triangle.b.z},
                                     {triangle.c.x, triangle.c.y, triangle.c.z}};
        block.set(lane, index, corners);
        part.box.grow(padded_bounds(triangle));
      }
    }
    part.cost = half_area(part.box) * blocks;
    return part;
  }

  WideBvh& bvh_;
  const Mesh& mesh_;
};

}  // namespace

void refit_wide(WideBvh& bvh, const Mesh& mesh, Executor& executor) {
  if (bvh.nodes.empty()) return;
  Refit refit(bvh, mesh);
  // Up to 64 subtrees, the grandchildren of the root, are refitted side by side; then the two
  // levels above them, one after the other.
  struct Job {
    std::uint32_t node;
    std::size_t child, grandchild;  // slots
  };
  std::vector<Job> jobs;
  std::vector<std::vector<Part>> parts(wide_fanout, std::vector<Part>(wide_fanout));
  const WideNode& root = bvh.nodes.front();
  const auto inner = [](const WideNode& node, int slot) {
    return Refit::in_use(node, slot) && !node.child[slot].is_leaf();
  };
  for (int child = 0; child < wide_fanout; ++child) {
    if (!inner(root, child)) continue;
    const WideNode& node = bvh.nodes[root.child[child].node()];
    for (int grandchild = 0; grandchild < wide_fanout; ++grandchild) {
      if (!inner(node, grandchild)) continue;
      jobs.push_back({node.child[grandchild].node(), static_cast<std::size_t>(child),
                      static_cast<std::size_t>(grandchild)});
    }
  }
  executor.for_each(jobs.size(), [&](std::size_t i) {
    parts[jobs[i].child][jobs[i].grandchild] = refit.node(jobs[i].node);
  });
  std::vector<Part> children(wide_fanout);
  for (int child = 0; child < wide_fanout; ++child) {
    if (!inner(root, child)) continue;
    const auto slot = static_cast<std::size_t>(child);
    children[slot] = refit.node(root.child[child].node(), &parts[slot]);
  }
  const Part whole = refit.node(0, &children);
  bvh.box = whole.box;
  const double area = half_area(whole.box);
  bvh.sah_cost = area > 0 ? whole.cost / area : whole.cost;
}

}  // namespace irt
