#include "renderer/bvh/wide_build.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>

#include "renderer/bvh/triangles.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wide_build.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wide_split-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// Nodes and blocks of one part of the tree, and what they add to the cost.
struct Part {
  std::vector<WideNode> nodes;
  std::vector<WideBlock> blocks;
  double cost = 0;
};

class Builder {
 public:
  Builder(const Mesh& mesh, Executor& executor)
      : mesh_(mesh),
        executor_(executor),
        count_(static_cast<std::uint32_t>(mesh.triangles.size())),
        buffers_{allocate(count_), allocate(count_)},
        subtree_(std::clamp(count_ / 32, 1024u, 16384u)) {}

  WideBvh build() {
    if (count_ == 0) return {};
    Range root{0, count_, 0, 0, 0, {}, {}};
    gather(root);
    Part top;
    add_node(top, root, true);
    return assemble(std::move(top), root);
  }

 private:
  /// A subtree that is left to a job, and the place in the top that refers to it.
  struct Subtree {
    Range range;
    std::uint32_t parent;
    int slot;
    Part part;
  };

  /// Triangles per job of a pass over many.
  static constexpr std::uint32_t chunk = 8192;

  struct Release {
    void operator()(Reference* data) const { ::operator delete (data, std::align_val_t{64}); }
  };
  using Buffer = std::unique_ptr<Reference[], Release>;
  static Buffer allocate(std::uint32_t count) {
    return Buffer(
        static_cast<Reference*>(::operator new (count * sizeof(Reference), std::align_val_t{64})));
  }

  template <class Job>
  void in_chunks(std::uint32_t count, const Job& job) const {
    const std::uint32_t chunks = (count + chunk - 1) / chunk;
    executor_.for_each(chunks, [&](std::size_t i) {
      const auto begin = static_cast<std::uint32_t>(i) * chunk;
      job(i, begin, std::min(count, begin + chunk));
    });
  }

  /// Fills the first buffer with every triangle's box and finds the unit of length.
  void gather(Range& root) {
    std::vector<Box> boxes((count_ + chunk - 1) / chunk);
    std::vector<CenterBounds> centers(boxes.size());
    in_chunks(count_, [&](std::size_t i, std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t triangle = begin; triangle < end; ++triangle) {
        const Box box = padded_bounds(triangle_of(mesh_, triangle));
        buffers_[0][triangle] = Reference(box, triangle);
        boxes[i].grow(box);
      }
      centers[i] = center_bounds(&buffers_[0][begin], end - begin);
    });
    for (const Box& box : boxes) root.box.grow(box);
    for (const CenterBounds& some : centers) root.centers.add(some);
    const Vec3 far = max(-root.box.lo, root.box.hi);
    const float largest = std::max({far.x, far.y, far.z, std::numeric_limits<float>::min()});
    // A power of two scales without rounding, so areas neither overflow nor vanish.
    measure_.unit = std::ldexp(1.0f, -std::clamp(std::ilogb(largest), -120, 120));
    root.area = measure_.half_area(root.box);
    root_area_ = root.area > 0 ? root.area : 1;
  }

  Reference* data(const Range& range) const { return buffers_[range.buffer].get() + range.begin; }
  Reference* other(const Range& range) const {
    return buffers_[1 - range.buffer].get() + range.begin;
  }

  Split find(const Range& range, bool together) const {
    const std::uint32_t count = range.count();
    if (!together || count <= chunk) {
      return find_split(data(range), count, range.centers, measure_);
    }
    const std::size_t chunks = (count + chunk - 1) / chunk;
    const Binning binning(range.centers, count);
    std::vector<Bins> bins(chunks);
    in_chunks(count, [&](std::size_t i, std::uint32_t begin, std::uint32_t end) {
      bins[i].fill(data(range) + begin, end - begin, binning);
    });
    Bins all = bins[0];
    for (std::size_t i = 1; i < chunks; ++i) all.add(bins[i], binning.bins);
    Split split = all.best(binning, measure_);
    if (split.found()) {
      for (const Bins& some : bins) split.chunk_lefts.push_back(some.left_of(split));
    }
    return split;
  }

  /// Moves the range's triangles to the other buffer, first those left of the split. Their order is
  /// kept, so it does not matter how many threads move them.
  std::array<CenterBounds, 2> move(const Range& range, const Split& split) const {
    const std::uint32_t count = range.count();
    if (split.chunk_lefts.empty()) {
      return partition(data(range), count, split, other(range), other(range) + split.left_count);
    }
    std::vector<std::uint32_t> lefts{0};
    for (const std::uint32_t some : split.chunk_lefts) lefts.push_back(lefts.back() + some);
    std::vector<std::array<CenterBounds, 2>> centers(split.chunk_lefts.size());
    in_chunks(count, [&](std::size_t i, std::uint32_t begin, std::uint32_t end) {
      Reference* const left = other(range) + lefts[i];
      Reference* const right = other(range) + split.left_count + (begin - lefts[i]);
      centers[i] = partition(data(range) + begin, end - begin, split, left, right);
    });
    for (std::size_t i = 1; i < centers.size(); ++i) {
      for (std::size_t side = 0; side < 2; ++side) centers[0][side].add(centers[i][side]);
    }
    return centers[0];
  }

  /// Splits `range` in two: by `split`, or in the middle where that has found nothing.
  void divide(const Range& range, const Split& split, Range& left, Range& right) const {
    left = right = range;
    if (!split.found()) {
      const std::uint32_t middle = range.begin + range.count() / 2;
      left.end = right.begin = middle;
      for (Range* half : {&left, &right}) {
        half->box = bounds(data(*half), half->count());
        half->area = measure_.half_area(half->box);
        half->centers = center_bounds(data(*half), half->count());
      }
      return;
    }
    const std::array<CenterBounds, 2> centers = move(range, split);
    left.centers = centers[0];
    right.centers = centers[1];
    left.end = right.begin = range.begin + split.left_count;
    left.buffer = right.buffer = 1 - range.buffer;
    left.box = split.left_box;
    right.box = split.right_box;
    left.area = split.left_area;
    right.area = split.right_area;
  }

  /// The cheapest split, or none where the tree is too deep or nothing to split by is left.
  Split split_of(const Range& range, bool together) const {
    return range.depth < wide_cost_depth ? find(range, together) : Split{};
  }

  /// Adds an inner node over `range` and all below it, in depth-first order; returns its index.
  /// At the top, subtrees of a size for one job are noted and left out.
  std::uint32_t add_node(Part& part, const Range& range, bool top) {
    return add_node(part, range, split_of(range, top), top);
  }

  std::uint32_t add_node(Part& part, const Range& range, const Split& first, bool top) {
    Range children[wide_fanout] = {range};
    int count = 1;
    if (range.count() > wide_block) {
      const Split* split = &first;
      Split found;
      int largest = 0;
      do {
        const Range whole = children[largest];
        divide(whole, *split, children[largest], children[count++]);
        largest = -1;
        if (count == wide_fanout) break;
        for (int i = 0; i < count; ++i) {
          if (children[i].count() <= wide_block) continue;
          if (largest < 0 || children[i].area > children[largest].area) largest = i;
        }
        if (largest >= 0) {
          found = split_of(children[largest], top);
          split = &found;
        }
      } while (largest >= 0);
    }
    part.cost += range.area;
    const auto node = static_cast<std::uint32_t>(part.nodes.size());
    part.nodes.emplace_back();
    for (int i = 0; i < count; ++i) {
      Range& child = children[i];
      child.depth = range.depth + 1;
      for (int axis = 0; axis < 3; ++axis) {
        part.nodes[node].plane[axis][i] = child.box.lo[axis];
        part.nodes[node].plane[axis + 3][i] = child.box.hi[axis];
      }
      if (top && child.count() > wide_most_in_leaf && child.count() <= subtree_) {
        subtrees_.push_back({child, node, i, {}});
        continue;
      }
      const WideChild below = add_child(part, child, top);
      part.nodes[node].child[i] = below;
    }
    return node;
  }

  WideChild add_child(Part& part, const Range& range, bool top) {
    if (range.count() <= wide_block) return add_leaf(part, range);
    const Split split = split_of(range, top);
    if (range.count() <= wide_most_in_leaf &&
        range.area * blocks_of(range.count()) <= range.area + split.cost) {
      return add_leaf(part, range);
    }
    return WideChild::inner(add_node(part, range, split, top));
  }

  WideChild add_leaf(Part& part, const Range& range) {
    const auto first = static_cast<std::uint32_t>(part.blocks.size());
    const std::uint32_t count = range.count();
    const std::uint32_t padded = (count + wide_block - 1) / wide_block * wide_block;
    part.blocks.resize(first + padded / wide_block);
    part.cost += range.area * blocks_of(count);
    const Reference* const references = data(range);
    for (std::uint32_t i = 0; i < padded; ++i) {
      const std::uint32_t triangle = references[std::min(i, count - 1)].triangle();
      float corners[3][3];
      for (int k = 0; k < 3; ++k) {
        const Vec3 corner = mesh_.corner(triangle, k);
        corners[k][0] = corner.x;
        corners[k][1] = corner.y;
        corners[k][2] = corner.z;
      }
      part.blocks[first + i / wide_block].set(static_cast<int>(i % wide_block), triangle, corners);
    }
    return WideChild::leaf(first, count);
  }

  WideBvh assemble(Part top, const Range& root) {
    executor_.for_each(subtrees_.size(), [&](std::size_t i) {
      Subtree& subtree = subtrees_[i];
      subtree.part.nodes.reserve(subtree.range.count() / 8);
      subtree.part.blocks.reserve(subtree.range.count() / 2);
      add_node(subtree.part, subtree.range, false);
    });
    std::vector<std::size_t> node_base, block_base;
    std::size_t nodes = top.nodes.size(), blocks = top.blocks.size();
    double cost = top.cost;
    for (const Subtree& subtree : subtrees_) {
      top.nodes[subtree.parent].child[subtree.slot] =
          WideChild::inner(static_cast<std::uint32_t>(nodes));
      node_base.push_back(nodes);
      block_base.push_back(blocks);
      nodes += subtree.part.nodes.size();
      blocks += subtree.part.blocks.size();
      cost += subtree.part.cost;
    }
    WideBvh bvh;
    bvh.sah_cost = cost / root_area_;
    bvh.box = root.box;
    bvh.nodes = std::move(top.nodes);
    bvh.blocks = std::move(top.blocks);
    bvh.nodes.resize(nodes);
    bvh.blocks.resize(blocks);
    executor_.for_each(subtrees_.size(), [&](std::size_t i) {
      const Part& part = subtrees_[i].part;
      std::copy(part.blocks.begin(), part.blocks.end(),
                bvh.blocks.begin() + static_cast<std::ptrdiff_t>(block_base[i]));
      WideNode* to = bvh.nodes.data() + node_base[i];
      for (const WideNode& node : part.nodes) {
        *to = node;
        for (WideChild& child : to->child) {
          child = child.moved(static_cast<std::uint32_t>(node_base[i]),
                              static_cast<std::uint32_t>(block_base[i]));
        }
        ++to;
      }
    });
    return bvh;
  }

  const Mesh& mesh_;
  Executor& executor_;
  std::uint32_t count_;
  Buffer buffers_[2];
  std::uint32_t subtree_;  ///< triangles at most in the subtree that one job builds
  Measure measure_;
  float root_area_ = 1;
  std::vector<Subtree> subtrees_;
};

WideBvh build(const Mesh& mesh, Executor& executor) {
  return Builder(mesh, executor).build();
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
