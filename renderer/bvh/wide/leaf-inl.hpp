/// The triangles of a leaf against packets. Included once per target.
#if defined(IRT_WIDE_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_LEAF_INL
#undef IRT_WIDE_LEAF_INL
#else
#define IRT_WIDE_LEAF_INL
#endif

#include <bit>
#include <cstdint>
#include <type_traits>

#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/packet-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// A value per triangle of a block.
using BlockFloats = Floats<wide_block>;

HWY_INLINE VecOf<BlockFloats> corner_of(const WideBlock& block, int corner) {
  return {BlockFloats::load(block.corner[corner][0]), BlockFloats::load(block.corner[corner][1]),
          BlockFloats::load(block.corner[corner][2])};
}

/// The triangles of a block as `Kernel` wants them.
template <class Kernel>
HWY_INLINE typename Kernel::template Triangle<BlockFloats> triangles_of(const WideBlock& block) {
  return Kernel::template prepare<BlockFloats>(
      CornersOf<BlockFloats>{corner_of(block, 0), corner_of(block, 1), corner_of(block, 2)});
}

/// irt::padded_bounds of a block's triangles. Computed when the first of them is met: most are not.
class BlockBoxes {
 public:
  explicit BlockBoxes(const WideBlock& block) : block_(block) {}

  [[nodiscard]] const WideBlock& block() const { return block_; }

  HWY_INLINE Box box(int lane) { return {corner(lane, 0, 1, 2), corner(lane, 3, 4, 5)}; }

  /// The corner of triangle `lane` on the given rows of WideNode::plane.
  HWY_INLINE Vec3 corner(int lane, int row_x, int row_y, int row_z) {
    if (!computed_) compute();
    return {plane_[row_x][lane], plane_[row_y][lane], plane_[row_z][lane]};
  }

 private:
  HWY_INLINE void compute() {
    computed_ = true;
    BlockFloats low[3], high[3], largest(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const BlockFloats a = BlockFloats::load(block_.corner[0][axis]);
      const BlockFloats b = BlockFloats::load(block_.corner[1][axis]);
      const BlockFloats c = BlockFloats::load(block_.corner[2][axis]);
      low[axis] = lesser(lesser(a, b), c);
      high[axis] = greater(greater(a, b), c);
      largest = greater(largest, greater(BlockFloats(0.0f) - low[axis], high[axis]));
    }
    const BlockFloats pad = largest * BlockFloats(box_pad);
    for (int axis = 0; axis < 3; ++axis) {
      (low[axis] - pad).store(plane_[axis]);
      (high[axis] + pad).store(plane_[axis + 3]);
    }
  }

  const WideBlock& block_;
  alignas(16) float plane_[6][wide_block];
  bool computed_ = false;
};

/// Where the lanes of a packet, whose signs are the bundle's, enter and leave a box.
template <int N>
struct LaneSlab {
  using F = Floats<N>;
  F entry, exit;

  /// From the distances of the planes along the axes.
  HWY_INLINE LaneSlab(const VecOf<F>& near, const VecOf<F>& far, const VecOf<F>& inverse)
      : entry(greater(greater(near.x * inverse.x, near.y * inverse.y),
                      greater(near.z * inverse.z, F(0.0f)))),
        exit(lesser(lesser(far.x * inverse.x, far.y * inverse.y), far.z * inverse.z) *
             F(exit_widening)) {}
  HWY_INLINE LaneSlab(const VecOf<F>& origin, const VecOf<F>& inverse, Vec3 near, Vec3 far)
      : LaneSlab(broadcast<F>(near) - origin, broadcast<F>(far) - origin, inverse) {}

  /// The lanes that are inside before `limit`.
  [[nodiscard]] HWY_INLINE Truths<N> reaches(const F& limit) const {
    return entry <= lesser(exit, limit);
  }
};

/// irt::meet per lane; whether any lane has a new hit. With `any_hit` such a lane drops out.
template <int N>
HWY_INLINE bool meet_lanes(BlockBoxes& boxes, int lane, const CrossingOf<Floats<N>>& crossing,
                           const Bundle& bundle, bool any_hit, Packet<N>& packet) {
  using F = Floats<N>;
  const LaneSlab<N> own(
      packet.line.origin, packet.inverse,
      boxes.corner(lane, bundle.near_row[0], bundle.near_row[1], bundle.near_row[2]),
      boxes.corner(lane, bundle.far_row(0), bundle.far_row(1), bundle.far_row(2)));
  const F t = select(crossing.t < own.entry, own.entry,
                     select(crossing.t < own.exit, crossing.t, own.exit));
  const Indices<N> index(boxes.block().index[lane]);
  const Truths<N> nearer = either(t < packet.t, both(t == packet.t, index < packet.triangle));
  const Truths<N> met = both(crossing.met, both(both(own.reaches(packet.t), t > F(0.0f)), nearer));
  if (!any(met)) return false;
  packet.t = select(met, any_hit ? F(-1.0f) : t, packet.t);
  if (any_hit) packet.line.end = select(met, F(-1.0f), packet.line.end);
  packet.u = select(met, crossing.u, packet.u);
  packet.v = select(met, crossing.v, packet.v);
  packet.triangle = select(met, index, packet.triangle);
  return true;
}

/// The rays of packets as `Kernel` wants them, made once per leaf where they are not kept as such.
template <class Kernel, int N>
class PacketLines {
  using Line = typename Kernel::template Line<Floats<N>>;
  static constexpr bool kept = std::is_same_v<Line, LineOf<Floats<N>>>;

 public:
  HWY_INLINE PacketLines(const Packet<N>* packets, unsigned inside) : packets_(packets) {
    if constexpr (!kept) {
      for (; inside != 0; inside &= inside - 1) {
        const int k = std::countr_zero(inside);
        lines_[k] = Kernel::template prepare<Floats<N>>(packets[k].line);
      }
    }
  }
  HWY_INLINE const Line& operator[](int k) const {
    if constexpr (kept) {
      return packets_[k].line;
    } else {
      return lines_[k];
    }
  }

 private:
  const Packet<N>* packets_;
  Line lines_[kept ? 1 : most_in_group];
};

/// Packets whose rays' directions have the signs of `bundle`, those of `inside`, against a leaf;
/// returns which of them have a new hit. What a block's triangles share is computed for all at
/// once, and with `one_origin`, where all rays start in one point, what the rays share as well.
template <class Kernel, int N, bool one_origin>
unsigned meet_leaf(const WideLeaf& leaf, const Bundle& bundle, bool any_hit, Packet<N>* packets,
                   unsigned inside) {
  using F = Floats<N>;
  using Prepared = std::conditional_t<one_origin, typename Kernel::template Seen<F>,
                                      typename Kernel::template Triangle<F>>;
  const PacketLines<Kernel, N> lines(packets, inside);
  unsigned changed = 0;
  const WideBlock* block = leaf.blocks;
  for (std::uint32_t first = 0; first < leaf.count; first += wide_block, ++block) {
    const auto prepared = [&]() HWY_ATTR {
      if constexpr (one_origin) {
        const float* const at = bundle.near_origin;
        return Kernel::see(triangles_of<Kernel>(*block),
                           broadcast<BlockFloats>({at[0], at[1], at[2]}));
      } else {
        return triangles_of<Kernel>(*block);
      }
    }();
    const ByLane<std::remove_const_t<decltype(prepared)>, wide_block> triangles(prepared);
    BlockBoxes boxes(*block);
    const auto count = static_cast<int>(std::min<std::uint32_t>(wide_block, leaf.count - first));
    for (int i = 0; i < count; ++i) {
      const auto triangle = triangles.template one<Prepared>(i);
      for (unsigned left = inside; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        CrossingOf<F> crossing;
        if constexpr (one_origin) {
          crossing = Kernel::cross_at(triangle, lines[k]);
        } else {
          crossing = cross_at<Kernel, F>(triangle, lines[k]);
        }
        if (!any(crossing.met)) continue;
        if (meet_lanes(boxes, i, crossing, bundle, any_hit, packets[k])) changed |= 1u << k;
      }
    }
  }
  return changed;
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
