/// One ray through the wide hierarchy, SIMD over the boxes of a node and the triangles of a block.
/// Included once per target.
#if defined(IRT_WIDE_SINGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_SINGLE_INL
#undef IRT_WIDE_SINGLE_INL
#else
#define IRT_WIDE_SINGLE_INL
#endif

#include <bit>
#include <cstdint>

#include "renderer/bvh/ray_loop.hpp"
#include "renderer/bvh/wide/leaf-inl.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/tracing/intersection.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// A value per child of a node.
using NodeFloats = Floats<wide_fanout>;

/// A subtree that waits, and where the ray enters it.
struct Waiting {
  WideChild child;
  float entry;
};
inline constexpr int most_waiting = wide_most_depth * (wide_fanout - 1) + 1;

/// A ray with every component in all lanes, and the rows of a node it meets first.
class SingleRay {
 public:
  explicit HWY_INLINE SingleRay(const TraversalRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      origin_[axis] = NodeFloats(ray.origin[axis]);
      inverse_[axis] = NodeFloats(ray.inverse[axis]);
      near_[axis] = axis + (ray.inverse[axis] < 0 ? 3 : 0);
    }
  }

  /// The children that the ray enters at or before `limit`, as bits, with their `entry`.
  HWY_INLINE unsigned enter(const WideNode& node, float limit, float* HWY_RESTRICT entry) const {
    const NodeFloats near = greater(greater(at(node, near_[0], 0), at(node, near_[1], 1)),
                                    greater(at(node, near_[2], 2), NodeFloats(0.0f)));
    const NodeFloats far =
        lesser(lesser(at(node, far_row(0), 0), at(node, far_row(1), 1)), at(node, far_row(2), 2));
    near.store(entry);
    return (near <= lesser(far * NodeFloats(exit_widening), NodeFloats(limit))).bits();
  }

 private:
  [[nodiscard]] int far_row(int axis) const { return near_[axis] < 3 ? axis + 3 : axis; }
  [[nodiscard]] HWY_INLINE NodeFloats at(const WideNode& node, int row, int axis) const {
    return (NodeFloats::load(node.plane[row]) - origin_[axis]) * inverse_[axis];
  }

  NodeFloats origin_[3], inverse_[3];
  int near_[3];
};

/// One ray against a leaf. With `any_hit`, returns after the first block with a hit.
template <class Kernel, bool any_hit>
HWY_INLINE void meet_leaf(const WideLeaf& leaf, const TraversalRay& ray,
                          const typename Kernel::template Line<BlockFloats>& line, Hit& best) {
  const WideBlock* block = leaf.blocks;
  for (std::uint32_t first = 0; first < leaf.count; first += wide_block, ++block) {
    const CrossingOf<BlockFloats> crossing =
        cross_at<Kernel, BlockFloats>(triangles_of<Kernel>(*block), line);
    unsigned met = crossing.met.bits();
    if (met == 0) continue;
    BlockBoxes boxes(*block);
    alignas(16) float t[wide_block], u[wide_block], v[wide_block];
    crossing.t.store(t);
    crossing.u.store(u);
    crossing.v.store(v);
    for (; met != 0; met &= met - 1) {
      const int lane = std::countr_zero(met);
      const Interval own = slab(boxes.box(lane), ray);
      irt::meet(block->index[lane], {t[lane], u[lane], v[lane], 0}, own, best);
    }
    if (any_hit && best.triangle != no_triangle) break;
  }
}

/// Puts the children in `entered` on the stack, the nearest on top.
HWY_INLINE void push_by_entry(const WideNode& node, unsigned entered,
                              const float* HWY_RESTRICT entry, Waiting*& top) {
  Waiting* const bottom = top;
  for (; entered != 0; entered &= entered - 1) {
    const int i = std::countr_zero(entered);
    Waiting* at = top++;
    for (; at != bottom && at[-1].entry < entry[i]; --at) at[0] = at[-1];
    *at = {node.child[i], entry[i]};
  }
}

/// Traces below `start` and improves `best`. With `any_hit`, returns at the first hit.
template <class Kernel, bool any_hit>
void trace_single(const WideBvh& bvh, const TraversalRay& from, Waiting start, TickProbe* probe,
                  Hit& best) {
  const SingleRay ray(from);
  const auto line = Kernel::template prepare<BlockFloats>(
      LineOf<BlockFloats>{broadcast<BlockFloats>(from.origin),
                          broadcast<BlockFloats>(from.direction), BlockFloats(from.limit)});
  Waiting stack[most_waiting];
  Waiting* top = stack;
  *top++ = start;
  while (top != stack) {
    const Waiting at = *--top;
    if (!(at.entry <= best.t)) continue;
    WideChild child = at.child;
    while (!child.is_leaf()) {
      const WideNode& node = bvh.nodes[child.node()];
      alignas(32) float entry[wide_fanout];
      unsigned entered = ray.enter(node, best.t, entry);
      if (entered == 0) goto next;
      const int first = std::countr_zero(entered);
      entered &= entered - 1;
      if (entered == 0) {
        child = node.child[first];
        continue;
      }
      const int second = std::countr_zero(entered);
      if ((entered & (entered - 1)) == 0) {
        const bool swap = entry[second] < entry[first];
        *top++ = {node.child[swap ? first : second], entry[swap ? first : second]};
        child = node.child[swap ? second : first];
        continue;
      }
      push_by_entry(node, entered | 1u << first, entry, top);
      child = (--top)->child;
    }
    if (probe != nullptr) probe->test_begins();
    meet_leaf<Kernel, any_hit>(bvh.leaf(child), from, line, best);
    if (probe != nullptr) probe->test_ends();
    if (any_hit && best.triangle != no_triangle) return;
  next:;
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
