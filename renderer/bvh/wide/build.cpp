#include "renderer/bvh/wide/build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wide/build.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wide/corners-inl.hpp"
#include "renderer/bvh/wide/split-inl.hpp"
#include "renderer/bvh/wide/top-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// The inner nodes and leaves of one part of the tree, and what they add to the cost.
struct Part {
  struct Leaf {
    const Reference* references;
    std::uint32_t count;
  };
  std::vector<WideNode> nodes;
  std::vector<Leaf> leaves;
  std::uint32_t blocks = 0;  ///< that the leaves will fill
  double cost = 0;
};

class Builder {
 public:
  /// `mesh` has triangles.
  Builder(const Mesh& mesh, Executor& executor)
      : corners_(mesh),
        executor_(executor),
        count_(static_cast<std::uint32_t>(mesh.triangles.size())),
        buffers_(count_),
        chunk_(std::clamp(count_ / 64, 1024u, 8192u)),
        subtree_(std::clamp(count_ / 32, 1024u, 16384u)) {}

  WideBvh build() {
    pieces_.push_back({gather()});
    split_top();
    build_subtrees();
    return assemble();
  }

 private:
  /// A subtree that is left to a job, and the place in the top that refers to it.
  struct Subtree {
    Range range;
    std::uint32_t parent;
    int slot;
    WideChild root;  ///< within the part
    Part part;
  };

  /// The range of all triangles. Fills the first buffer with their boxes and finds the unit of
  /// length.
  Range gather() {
    const std::uint32_t chunks = (count_ + chunk_ - 1) / chunk_;
    std::vector<Box> boxes(chunks);
    std::vector<CenterBounds> centers(chunks);
    Range root{0, count_, 0, 0, 0, {}, {}};
    Reference* const references = buffers_.of(root);
    executor_.for_each(chunks, [&](std::size_t i) {
      const std::uint32_t begin = static_cast<std::uint32_t>(i) * chunk_;
      const std::uint32_t end = std::min(count_, begin + chunk_);
      for (std::uint32_t triangle = begin; triangle < end; ++triangle) {
        references[triangle] = reference_to(corners_, triangle);
      }
      boxes[i] = bounds(references + begin, end - begin);
      centers[i] = center_bounds(references + begin, end - begin);
    });
    for (const Box& box : boxes) root.box.grow(box);
    for (const CenterBounds& some : centers) root.centers.add(some);
    const Vec3 far = max(-root.box.lo, root.box.hi);
    const float largest = std::max({far.x, far.y, far.z, std::numeric_limits<float>::min()});
    // A power of two scales without rounding, so areas neither overflow nor vanish.
    measure_.unit = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -120, 120));
    root.area = measure_.half_area(root.box);
    return root;
  }

  /// Splits pieces until every node of the top has the children it wants and all else is small
  /// enough for a job.
  void split_top() {
    TopSplitter splitter(buffers_, measure_, chunk_, executor_);
    std::vector<PieceToSplit> wanted;
    for (int level = 0; level == 0 || !wanted.empty(); ++level) {
      const std::size_t before = pieces_.size();
      splitter.split(wanted, pieces_);
      wanted.clear();
      // Large pieces will be split in any case. In the wide tree they are no deeper than `level`.
      for (std::size_t i = level == 0 ? 0 : before; i < pieces_.size(); ++i) {
        if (pieces_[i].range.count() > subtree_ && level < wide_cost_depth) {
          wanted.push_back({static_cast<std::uint32_t>(i), true});
        }
      }
      if (!wanted.empty()) continue;
      top_.clear();
      subtrees_.clear();
      cost_ = 0;
      add_top_node(0, 0, wanted);
    }
  }

  /// The one among `children` that is to be split next: of those too large for a leaf of one block
  /// the one with the largest surface; -1 if there is none.
  static int next_to_split(const Range* children, int count) {
    int largest = -1;
    for (int i = 0; i < count; ++i) {
      if (children[i].count() <= wide_block) continue;
      if (largest < 0 || children[i].area > children[largest].area) largest = i;
    }
    return largest;
  }

  /// Adds a node over a piece, and all top nodes below. Where pieces have yet to be split for that,
  /// adds them to `wanted`, and what else it does is of no use.
  std::uint32_t add_top_node(std::uint32_t piece, int depth, std::vector<PieceToSplit>& wanted) {
    std::uint32_t pieces[wide_fanout] = {piece};
    Range children[wide_fanout] = {pieces_[piece].range};
    int count = 1;
    while (count < wide_fanout) {
      const int next = next_to_split(children, count);
      if (next < 0) break;
      const std::uint32_t left = pieces_[pieces[next]].left;
      if (left == 0) {
        wanted.push_back({pieces[next], depth < wide_cost_depth});
        return 0;
      }
      pieces[next] = left;
      pieces[count] = left + 1;
      children[next] = pieces_[left].range;
      children[count++] = pieces_[left + 1].range;
    }
    cost_ += pieces_[piece].range.area;
    const auto node = static_cast<std::uint32_t>(top_.size());
    top_.push_back(node_over(children, count));
    for (int i = 0; i < count; ++i) {
      if (children[i].count() > subtree_) {
        const std::uint32_t below = add_top_node(pieces[i], depth + 1, wanted);
        top_[node].child[i] = WideChild::inner(below);
      } else {
        children[i].depth = depth + 1;
        subtrees_.push_back({children[i], node, i, {}, {}});
      }
    }
    return node;
  }

  static WideNode node_over(const Range* children, int count) {
    WideNode node = WideNode::without_children();
    for (int i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[axis][i] = children[i].box.lo[axis];
        node.plane[axis + 3][i] = children[i].box.hi[axis];
      }
    }
    return node;
  }

  void build_subtrees() {
    // The largest first, so that at the end no thread is left alone with one.
    order_.resize(subtrees_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, [&](std::size_t a, std::size_t b) {
      return subtrees_[a].range.count() > subtrees_[b].range.count();
    });
    executor_.for_each(order_.size(), [&](std::size_t i) {
      Subtree& subtree = subtrees_[order_[i]];
      subtree.part.nodes.reserve(subtree.range.count() / 8);
      subtree.part.leaves.reserve(subtree.range.count() / 2);
      subtree.root = add_child(subtree.part, subtree.range);
    });
  }

  /// Splits `range` in two: by `split`, or in the middle where that has found nothing.
  void divide(const Range& range, const Split& split, Range& left, Range& right) const {
    if (!split.found()) return halve(buffers_, measure_, range, left, right);
    Reference* const to = buffers_.other(range);
    const std::array<CenterBounds, 2> centers =
        partition(buffers_.of(range), range.count(), split, to, to + split.left_count);
    part_by(split, centers, range, left, right);
  }

  /// The cheapest split, or none where the tree is too deep or nothing to split by is left.
  [[nodiscard]] Split split_of(const Range& range) const {
    if (range.depth >= wide_cost_depth) return {};
    return find_split(buffers_.of(range), range.count(), range.centers, measure_);
  }

  WideChild add_child(Part& part, const Range& range) const {
    if (range.count() <= wide_block) return add_leaf(part, range);
    const Split split = split_of(range);
    if (range.count() <= wide_most_in_leaf &&
        range.area * blocks_of(range.count()) <= range.area + split.cost) {
      return add_leaf(part, range);
    }
    return WideChild::inner(add_node(part, range, split));
  }

  /// Adds an inner node over `range` and all below it, in depth-first order; returns its index.
  std::uint32_t add_node(Part& part, const Range& range, const Split& first) const {
    Range children[wide_fanout];
    divide(range, first, children[0], children[1]);
    int count = 2;
    while (count < wide_fanout) {
      const int next = next_to_split(children, count);
      if (next < 0) break;
      const Range whole = children[next];
      divide(whole, split_of(whole), children[next], children[count++]);
    }
    part.cost += range.area;
    const auto node = static_cast<std::uint32_t>(part.nodes.size());
    part.nodes.push_back(node_over(children, count));
    for (int i = 0; i < count; ++i) {
      children[i].depth = range.depth + 1;
      const WideChild below = add_child(part, children[i]);
      part.nodes[node].child[i] = below;
    }
    return node;
  }

  WideChild add_leaf(Part& part, const Range& range) const {
    const std::uint32_t first = part.blocks, count = range.count();
    part.leaves.push_back({buffers_.of(range), count});
    part.blocks += (count + wide_block - 1) / wide_block;
    part.cost += range.area * blocks_of(count);
    return WideChild::leaf(first, count);
  }

  WideBvh assemble() {
    std::vector<std::uint32_t> node_base, block_base;
    auto nodes = static_cast<std::uint32_t>(top_.size());
    std::uint32_t blocks = 0;
    for (const Subtree& subtree : subtrees_) {
      top_[subtree.parent].child[subtree.slot] = subtree.root.moved(nodes, blocks);
      node_base.push_back(nodes);
      block_base.push_back(blocks);
      nodes += static_cast<std::uint32_t>(subtree.part.nodes.size());
      blocks += subtree.part.blocks;
      cost_ += subtree.part.cost;
    }
    WideBvh bvh;
    const Range& root = pieces_[0].range;
    bvh.sah_cost = cost_ / (root.area > 0 ? root.area : 1);
    bvh.box = root.box;
    bvh.nodes.resize(nodes);
    bvh.blocks.resize(blocks);
    std::ranges::copy(top_, bvh.nodes.begin());
    executor_.for_each(order_.size(), [&](std::size_t i) {
      const std::size_t at = order_[i];
      write(subtrees_[at].part, node_base[at], block_base[at], bvh);
    });
    return bvh;
  }

  /// Puts a part to its place.
  void write(const Part& part, std::uint32_t first_node, std::uint32_t first_block,
             WideBvh& bvh) const {
    WideNode* to = bvh.nodes.data() + first_node;
    for (const WideNode& node : part.nodes) {
      *to = node;
      for (WideChild& child : to->child) child = child.moved(first_node, first_block);
      ++to;
    }
    WideBlock* block = bvh.blocks.data() + first_block;
    for (const Part::Leaf& leaf : part.leaves) {
      for (std::uint32_t i = 0; i < leaf.count; i += wide_block) {
        std::uint32_t triangles[wide_block];
        for (std::uint32_t lane = 0; lane < wide_block; ++lane) {
          triangles[lane] = leaf.references[std::min(i + lane, leaf.count - 1)].triangle();
        }
        set_block(corners_, triangles, *block++);
      }
    }
  }

  Corners corners_;
  Executor& executor_;
  std::uint32_t count_;
  Buffers buffers_;
  std::uint32_t chunk_;    ///< triangles at most in a chunk of a pass that all threads share
  std::uint32_t subtree_;  ///< triangles at most in the subtree that one job builds
  Measure measure_;
  std::vector<Piece> pieces_;
  std::vector<WideNode> top_;
  std::vector<Subtree> subtrees_;
  std::vector<std::size_t> order_;  ///< in which subtrees are built
  double cost_ = 0;
};

WideBvh build(const Mesh& mesh, Executor& executor) {
  return mesh.triangles.empty() ? WideBvh() : Builder(mesh, executor).build();
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(build);

WideBvh build_wide(const Mesh& mesh, Executor& executor) {
  return HWY_DYNAMIC_DISPATCH(build)(mesh, executor);
}

}  // namespace irt
#endif
