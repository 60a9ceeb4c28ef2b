/// One ray through the wide hierarchy, SIMD over the boxes of a node and the triangles of a block.
/// Included once per instruction set.
#if defined(IRT_WIDE_SINGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_SINGLE_INL
#undef IRT_WIDE_SINGLE_INL
#else
#define IRT_WIDE_SINGLE_INL
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>

#include "renderer/bvh/wide_bvh.hpp"
#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/packet_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A subtree that waits, and where the ray enters it.
struct Waiting {
  WideChild child;
  float entry;
};
inline constexpr int most_waiting = wide_most_depth * (wide_fanout - 1) + 1;

/// A ray with every component in all lanes, and the rows of a node it meets first.
class SingleRay {
  using D = hn::CappedTag<float, wide_fanout>;
  using V = hn::Vec<D>;
  static constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));

 public:
  explicit SingleRay(const TraversalRay& ray) : ray_(ray) {
    const D d;
    for (int axis = 0; axis < 3; ++axis) {
      origin_[axis] = hn::Set(d, ray.origin[axis]);
      inverse_[axis] = hn::Set(d, ray.inverse[axis]);
      near_[axis] = axis + (ray.inverse[axis] < 0 ? 3 : 0);
    }
  }

  const TraversalRay& ray() const { return ray_; }

  /// The children that the ray enters at or before `limit`, as bits, with their `entry`.
  HWY_INLINE unsigned enter(const WideNode& node, float limit, float* HWY_RESTRICT entry) const {
    const D d;
    unsigned entered = 0;
    for (int i = 0; i < wide_fanout; i += lanes) {
      const V near = hn::Max(hn::Max(at(node, near_[0], 0, i), at(node, near_[1], 1, i)),
                             hn::Max(at(node, near_[2], 2, i), hn::Zero(d)));
      const V far = hn::Min(hn::Min(at(node, far_row(0), 0, i), at(node, far_row(1), 1, i)),
                            at(node, far_row(2), 2, i));
      const V last = hn::Min(hn::Mul(far, hn::Set(d, 1.0f + 0x1p-21f)), hn::Set(d, limit));
      entered |= bits(d, hn::Le(near, last)) << i;
      hn::Store(near, d, entry + i);
    }
    return entered;
  }

 private:
  int far_row(int axis) const { return near_[axis] < 3 ? axis + 3 : axis; }
  HWY_INLINE V at(const WideNode& node, int row, int axis, int i) const {
    return hn::Mul(hn::Sub(hn::Load(D(), node.plane[row] + i), origin_[axis]), inverse_[axis]);
  }

  const TraversalRay& ray_;
  V origin_[3], inverse_[3];
  int near_[3];
};

/// irt::padded_bounds of a block's triangles. Computed when the first of them is met: most are not.
class BlockBoxes {
 public:
  explicit BlockBoxes(const WideBlock& block) : block_(block) {}

  const WideBlock& block() const { return block_; }

  HWY_INLINE Box box(int lane) { return {corner(lane, 0, 1, 2), corner(lane, 3, 4, 5)}; }

  /// The corner of triangle `lane` on the given rows of WideNode::plane.
  HWY_INLINE Vec3 corner(int lane, int row_x, int row_y, int row_z) {
    if (!computed_) compute();
    return {plane_[row_x][lane], plane_[row_y][lane], plane_[row_z][lane]};
  }

 private:
  HWY_INLINE void compute() {
    using D = hn::CappedTag<float, wide_block>;
    using V = hn::Vec<D>;
    const D d;
    computed_ = true;
    for (int i = 0; i < wide_block; i += static_cast<int>(hn::MaxLanes(d))) {
      V low[3], high[3], largest = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        const V a = hn::Load(d, block_.corner[0][axis] + i);
        const V b = hn::Load(d, block_.corner[1][axis] + i);
        const V c = hn::Load(d, block_.corner[2][axis] + i);
        low[axis] = hn::Min(hn::Min(a, b), c);
        high[axis] = hn::Max(hn::Max(a, b), c);
        largest = hn::Max(largest, hn::Max(hn::Neg(low[axis]), high[axis]));
      }
      const V pad = hn::Mul(largest, hn::Set(d, 0x1p-22f));
      for (int axis = 0; axis < 3; ++axis) {
        hn::Store(hn::Sub(low[axis], pad), d, plane_[axis] + i);
        hn::Store(hn::Add(high[axis], pad), d, plane_[axis + 3] + i);
      }
    }
  }

  const WideBlock& block_;
  alignas(16) float plane_[6][wide_block];
  bool computed_ = false;
};

/// Tests a leaf's triangles. With `any`, returns at the first hit.
template <bool any, class Probe>
HWY_INLINE void meet_leaf(const WideBvh& bvh, WideChild leaf, const TraversalRay& ray, Hit& best,
                          Probe& probe) {
  using D = hn::CappedTag<float, wide_block>;
  const D d;
  constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));
  const Vectors<D> origin = spread(d, ray.origin);
  const Vectors<D> direction = spread(d, ray.direction);
  const WideBlock* block = bvh.blocks.data() + leaf.first_block();
  probe.test_begins();
  for (std::uint32_t first = 0; first < leaf.count(); first += wide_block, ++block) {
    BlockBoxes boxes(*block);
    for (int i = 0; i < wide_block; i += lanes) {
      const KernelHit<D> hit =
          moller_trumbore(d, load(d, block->corner[0], i), load(d, block->corner[1], i),
                          load(d, block->corner[2], i), origin, direction);
      unsigned met = bits(d, hit.met);
      if (met == 0) continue;
      alignas(64) float t[lanes], u[lanes], v[lanes];
      hn::Store(hit.t, d, t);
      hn::Store(hit.u, d, u);
      hn::Store(hit.v, d, v);
      for (; met != 0; met &= met - 1) {
        const int lane = std::countr_zero(met);
        const Interval own = slab(boxes.box(i + lane), ray);
        meet(block->index[i + lane], {t[lane], u[lane], v[lane], 0}, own, best);
      }
      if (any && best.triangle != no_triangle) break;
    }
  }
  probe.test_ends();
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

/// Traces below `start` and improves `best`. With `any`, returns at the first hit.
template <bool any, class Probe>
inline void trace_single(const WideBvh& bvh, const SingleRay& ray, Waiting start, Hit& best,
                         Probe& probe) {
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
    meet_leaf<any>(bvh, child, ray.ray(), best, probe);
    if (any && best.triangle != no_triangle) return;
  next:;
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
