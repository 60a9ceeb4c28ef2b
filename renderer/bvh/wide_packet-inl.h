/// A packet of rays through the wide hierarchy. Included once per instruction set.
#if defined(IRT_WIDE_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_PACKET_INL
#undef IRT_WIDE_PACKET_INL
#else
#define IRT_WIDE_PACKET_INL
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>

#include "renderer/bvh/wide_bvh.hpp"
#include "renderer/bvh/wide_single-inl.h"
#include "renderer/tracing/packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Distances of a node's planes from a bundle's origin, along the axes: near x, y, z, then far.
struct alignas(64) PlaneDistances {
  float of[6][wide_fanout];
};

/// A bundle's bounds against the eight boxes of a node at once.
class BundleTest {
  using D = hn::CappedTag<float, wide_fanout>;
  using V = hn::Vec<D>;
  static constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));

 public:
  explicit BundleTest(const Bundle& bundle) : bundle_(bundle) {}

  /// The children that some ray may enter at or before `limit`, as bits, with a bound of the entry.
  HWY_INLINE unsigned enter(const WideNode& node, float limit, float* HWY_RESTRICT entry,
                            PlaneDistances& distances) const {
    const D d;
    unsigned entered = 0;
    for (int i = 0; i < wide_fanout; i += lanes) {
      const V near = hn::Max(hn::Max(first(node, 0, i, distances), first(node, 1, i, distances)),
                             hn::Max(first(node, 2, i, distances), hn::Zero(d)));
      const V far = hn::Min(hn::Min(last(node, 0, i, distances), last(node, 1, i, distances)),
                            last(node, 2, i, distances));
      const V end = hn::Min(hn::Mul(far, hn::Set(d, 1.0f + 0x1p-21f)), hn::Set(d, limit));
      entered |= bits(d, hn::Le(near, end)) << i;
      hn::Store(near, d, entry + i);
    }
    return entered;
  }

 private:
  HWY_INLINE V first(const WideNode& node, int axis, int i, PlaneDistances& distances) const {
    const D d;
    const V distance = hn::Sub(hn::Load(d, node.plane[bundle_.near_row[axis]] + i),
                               hn::Set(d, bundle_.near_origin[axis]));
    hn::Store(distance, d, distances.of[axis] + i);
    return hn::Min(hn::Mul(distance, hn::Set(d, bundle_.least_inverse[axis])),
                   hn::Mul(distance, hn::Set(d, bundle_.most_inverse[axis])));
  }
  HWY_INLINE V last(const WideNode& node, int axis, int i, PlaneDistances& distances) const {
    const D d;
    const V distance = hn::Sub(hn::Load(d, node.plane[bundle_.far_row(axis)] + i),
                               hn::Set(d, bundle_.far_origin[axis]));
    hn::Store(distance, d, distances.of[axis + 3] + i);
    return hn::Max(hn::Mul(distance, hn::Set(d, bundle_.least_inverse[axis])),
                   hn::Mul(distance, hn::Set(d, bundle_.most_inverse[axis])));
  }

  const Bundle bundle_;
};

/// Where the lanes of a packet, whose signs are the bundle's, enter and leave a box.
template <class D>
struct LaneSlab {
  using V = hn::Vec<D>;
  V entry, exit;

  /// From the products of distances and inverses.
  HWY_INLINE LaneSlab(D d, V near_x, V near_y, V near_z, V far_x, V far_y, V far_z)
      : entry(hn::Max(hn::Max(near_x, near_y), hn::Max(near_z, hn::Zero(d)))),
        exit(hn::Mul(hn::Min(hn::Min(far_x, far_y), far_z), hn::Set(d, 1.0f + 0x1p-21f))) {}
};

template <class D>
HWY_INLINE LaneSlab<D> lane_slab(D d, const Vectors<D>& origin, const Vectors<D>& inverse,
                                 Vec3 near, Vec3 far) {
  const auto at = [&](float plane, hn::Vec<D> from, hn::Vec<D> by)
                      HWY_ATTR { return hn::Mul(hn::Sub(hn::Set(d, plane), from), by); };
  return {d,
          at(near.x, origin.x, inverse.x),
          at(near.y, origin.y, inverse.y),
          at(near.z, origin.z, inverse.z),
          at(far.x, origin.x, inverse.x),
          at(far.y, origin.y, inverse.y),
          at(far.z, origin.z, inverse.z)};
}

/// The same for child `i` of a node whose planes' distances from the common origin are known.
template <class D>
HWY_INLINE LaneSlab<D> lane_slab(D d, const PlaneDistances& distances, int i,
                                 const Vectors<D>& inverse) {
  const auto at = [&](int row, hn::Vec<D> by)
                      HWY_ATTR { return hn::Mul(hn::Set(d, distances.of[row][i]), by); };
  return {d,
          at(0, inverse.x),
          at(1, inverse.y),
          at(2, inverse.z),
          at(3, inverse.x),
          at(4, inverse.y),
          at(5, inverse.z)};
}

/// The part of the triangle test that rays share, for a block at once.
template <bool one_origin>
class BlockSeen {
  using D = hn::CappedTag<float, wide_block>;
  static constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));

 public:
  HWY_INLINE BlockSeen(const WideBlock& block, const float (&origin)[3]) {
    const D d;
    for (int i = 0; i < wide_block; i += lanes) {
      const Vectors<D> a = load(d, block.corner[0], i);
      const Vectors<D> edge1 = subtract<D>(load(d, block.corner[1], i), a);
      const Vectors<D> edge2 = subtract<D>(load(d, block.corner[2], i), a);
      store(edge1, 0, i);
      store(edge2, 3, i);
      if constexpr (one_origin) {
        const SeenFrom<D> seen(edge1, edge2,
                               subtract<D>(spread(d, {origin[0], origin[1], origin[2]}), a));
        store(seen.s, 6, i);
        store(seen.q, 9, i);
        hn::Store(seen.height, d, of_[12] + i);
      }
    }
  }

  /// Triangle `i` in all lanes of `to`, seen from the common origin or from each lane's own.
  template <class To>
  HWY_INLINE SeenFrom<To> of(To to, int i, const WideBlock& block,
                             const Vectors<To>& origin) const {
    const Vectors<To> edge1 = pick(to, 0, i), edge2 = pick(to, 3, i);
    if constexpr (one_origin) {
      return {edge1, edge2, pick(to, 6, i), pick(to, 9, i), hn::Set(to, of_[12][i])};
    } else {
      const Vectors<To> a{hn::Set(to, block.corner[0][0][i]), hn::Set(to, block.corner[0][1][i]),
                          hn::Set(to, block.corner[0][2][i])};
      return {edge1, edge2, subtract<To>(origin, a)};
    }
  }

 private:
  HWY_INLINE void store(const Vectors<D>& x, int row, int i) {
    const D d;
    hn::Store(x.x, d, of_[row] + i);
    hn::Store(x.y, d, of_[row + 1] + i);
    hn::Store(x.z, d, of_[row + 2] + i);
  }
  template <class To>
  HWY_INLINE Vectors<To> pick(To to, int row, int i) const {
    return {hn::Set(to, of_[row][i]), hn::Set(to, of_[row + 1][i]), hn::Set(to, of_[row + 2][i])};
  }

  alignas(64) float of_[one_origin ? 13 : 6][wide_block];
};

/// irt::meet per lane; whether any lane has a new hit.
template <bool any, class D>
HWY_INLINE bool meet_lanes(BlockBoxes& boxes, int lane, const KernelHit<D>& hit,
                           const Bundle& bundle, Packet<D>& packet) {
  using V = hn::Vec<D>;
  const D d;
  const hn::Rebind<std::uint32_t, D> du;
  const LaneSlab<D> own =
      lane_slab(d, packet.origin, packet.inverse,
                boxes.corner(lane, bundle.near_row[0], bundle.near_row[1], bundle.near_row[2]),
                boxes.corner(lane, bundle.far_row(0), bundle.far_row(1), bundle.far_row(2)));
  const V t = hn::IfThenElse(hn::Lt(hit.t, own.entry), own.entry,
                             hn::IfThenElse(hn::Lt(hit.t, own.exit), hit.t, own.exit));
  const auto index = hn::Set(du, boxes.block().index[lane]);
  const hn::Mask<D> lower = hn::RebindMask(d, hn::Lt(index, packet.triangle));
  const hn::Mask<D> nearer = hn::Or(hn::Lt(t, packet.t), hn::And(hn::Eq(t, packet.t), lower));
  const hn::Mask<D> reached =
      hn::And(hn::Le(own.entry, hn::Min(own.exit, packet.t)), hn::Gt(t, hn::Zero(d)));
  const hn::Mask<D> met = hn::And(hit.met, hn::And(reached, nearer));
  if (hn::AllFalse(d, met)) return false;
  if constexpr (any) {
    packet.t = hn::IfThenElse(met, hn::Set(d, -1.0f), packet.t);
  } else {
    packet.t = hn::IfThenElse(met, t, packet.t);
    packet.u = hn::IfThenElse(met, hit.u, packet.u);
    packet.v = hn::IfThenElse(met, hit.v, packet.v);
  }
  packet.triangle = hn::IfThenElse(hn::RebindMask(du, met), index, packet.triangle);
  return true;
}

/// How many must be left of a packet or a group for it to go on as one. Measured on the three
/// scenes: from 1 to 4 little changes.
struct TogetherLimits {
  int lanes = 2;    ///< in an inner node, at most so many lanes go on as single rays
  int packets = 2;  ///< at most so many packets leave their group
};

/// One packet whose rays' directions have the same signs. In every node the bounds of all its rays
/// cull children first (Boulos, Wald and Shirley 2006), then the lanes test the boxes that are
/// left. Where few lanes are left they go on as single rays (Benthin, Wald, Woop, Ernst and Mark
/// 2012, "Combining single and packet-ray tracing for arbitrary ray distributions").
///
/// With `any`, a lane that has met something drops out. With `one_origin`, all rays start in one
/// point, and what they share of each test is computed once.
template <bool any, bool one_origin, class D, class Probe>
class PacketTrace {
  using V = hn::Vec<D>;
  static constexpr int lanes = Packet<D>::lanes;

 public:
  HWY_INLINE PacketTrace(const WideBvh& bvh, Packet<D>& packet, const Bundle& bundle,
                         const TogetherLimits& limits, Probe& probe)
      : bvh_(bvh), packet_(packet), bundle_(bundle), test_(bundle), limits_(limits), probe_(probe) {
    update_limit();
  }

  void run(WideChild start) {
    const D d;
    const int far_row[3] = {bundle_.far_row(0), bundle_.far_row(1), bundle_.far_row(2)};
    const Vectors<D> origin = packet_.origin, inverse = packet_.inverse;
    Waiting stack[most_waiting];
    alignas(64) float entries[most_waiting][lanes];
    int top = 0;
    stack[top] = {start, 0};
    hn::Store(hn::Zero(d), d, entries[top++]);
    while (top > 0) {
      --top;
      if (!(stack[top].entry <= limit_)) continue;
      const WideChild child = stack[top].child;
      const unsigned inside = bits(d, hn::Le(hn::Load(d, entries[top]), packet_.t));
      if (inside == 0) continue;
      const int count = std::popcount(inside);
      if (child.is_leaf()) {
        probe_.test_begins();
        leaf(child);
        probe_.test_ends();
        if (limit_ < 0) return;
        continue;
      }
      if (count <= limits_.lanes) {
        singly(child, inside);
        if (limit_ < 0) return;
        continue;
      }
      const WideNode& node = bvh_.nodes[child.node()];
      alignas(32) float bound[wide_fanout];
      PlaneDistances distances;
      unsigned entered = test_.enter(node, limit_, bound, distances);
      const int bottom = top;
      for (; entered != 0; entered &= entered - 1) {
        const int i = std::countr_zero(entered);
        const LaneSlab<D> slab =
            one_origin ? lane_slab(d, distances, i, inverse)
                       : lane_slab(d, origin, inverse, corner(node, i, bundle_.near_row),
                                   corner(node, i, far_row));
        const hn::Mask<D> in = hn::Le(slab.entry, hn::Min(slab.exit, packet_.t));
        if (hn::AllFalse(d, in)) continue;
        int at = top++;
        for (; at != bottom && stack[at - 1].entry < bound[i]; --at) {
          stack[at] = stack[at - 1];
          hn::Store(hn::Load(d, entries[at - 1]), d, entries[at]);
        }
        stack[at] = {node.child[i], bound[i]};
        hn::Store(hn::IfThenElse(in, slab.entry, hn::Set(d, WideNode::infinity)), d, entries[at]);
      }
    }
  }

 private:
  static HWY_INLINE Vec3 corner(const WideNode& node, int i, const int (&rows)[3]) {
    return {node.plane[rows[0]][i], node.plane[rows[1]][i], node.plane[rows[2]][i]};
  }

  void update_limit() { limit_ = hn::GetLane(hn::MaxOfLanes(D(), packet_.t)); }

  /// All lanes against the leaf's triangles one after the other.
  HWY_INLINE void leaf(WideChild child) {
    const D d;
    const WideBlock* block = bvh_.blocks.data() + child.first_block();
    const Vectors<D> origin = packet_.origin, direction = packet_.direction;
    bool changed = false;
    for (std::uint32_t first = 0; first < child.count(); first += wide_block, ++block) {
      const BlockSeen<one_origin> seen(*block, bundle_.near_origin);
      BlockBoxes boxes(*block);
      const std::uint32_t count = std::min<std::uint32_t>(wide_block, child.count() - first);
      for (std::uint32_t i = 0; i < count; ++i) {
        const KernelHit<D> hit =
            moller_trumbore(d, seen.of(d, static_cast<int>(i), *block, origin), direction);
        if (hn::AllFalse(d, hit.met)) continue;
        changed |= meet_lanes<any>(boxes, static_cast<int>(i), hit, bundle_, packet_);
      }
    }
    if (changed) update_limit();
  }

  /// One ray of the packet on its own.
  struct Lane {
    TraversalRay ray{Ray{}};
    Hit best;
  };
  HWY_INLINE Lane take(int lane) const {
    const auto pick = [lane](V x) HWY_ATTR {
      alignas(64) float values[lanes];
      hn::Store(x, D(), values);
      return values[lane];
    };
    const auto pick3 = [&](const Vectors<D>& x) HWY_ATTR {
      return Vec3{pick(x.x), pick(x.y), pick(x.z)};
    };
    Lane result;
    result.ray.origin = pick3(packet_.origin);
    result.ray.direction = pick3(packet_.direction);
    result.ray.inverse = pick3(packet_.inverse);
    result.ray.limit = pick(packet_.t);
    alignas(64) std::uint32_t triangles[lanes];
    hn::Store(packet_.triangle, hn::Rebind<std::uint32_t, D>(), triangles);
    result.best = {result.ray.limit, 0, 0, triangles[lane]};
    return result;
  }
  HWY_INLINE void put(int lane, const Hit& hit) {
    const D d;
    const hn::Rebind<std::uint32_t, D> du;
    const hn::Mask<D> here = lanes_of(d, 1u << lane);
    packet_.t = hn::IfThenElse(here, hn::Set(d, any ? -1.0f : hit.t), packet_.t);
    packet_.u = hn::IfThenElse(here, hn::Set(d, hit.u), packet_.u);
    packet_.v = hn::IfThenElse(here, hn::Set(d, hit.v), packet_.v);
    packet_.triangle =
        hn::IfThenElse(hn::RebindMask(du, here), hn::Set(du, hit.triangle), packet_.triangle);
  }

  template <class Trace>
  HWY_INLINE void each(unsigned which, const Trace& trace) {
    bool changed = false;
    for (; which != 0; which &= which - 1) {
      const int lane = std::countr_zero(which);
      Lane ray = take(lane);
      const Hit before = ray.best;
      trace(ray);
      if (ray.best.t == before.t && ray.best.triangle == before.triangle) continue;
      put(lane, ray.best);
      changed = true;
    }
    if (changed) update_limit();
  }

  void singly(WideChild child, unsigned which) {
    each(which, [&](Lane& lane) HWY_ATTR {
      trace_single<any>(bvh_, SingleRay(lane.ray), {child, 0}, lane.best, probe_);
    });
  }

  const WideBvh& bvh_;
  Packet<D>& packet_;
  const Bundle& bundle_;
  BundleTest test_;
  const TogetherLimits& limits_;
  Probe& probe_;
  float limit_ = 0;  ///< the largest `t` of any lane
};

template <bool any, class D, class Probe>
HWY_INLINE void trace_alike(const WideBvh& bvh, Packet<D>& packet, const Bundle& bundle,
                            const TogetherLimits& limits, Probe& probe) {
  if (bundle.one_origin()) {
    PacketTrace<any, true, D, Probe>(bvh, packet, bundle, limits, probe).run(WideChild::inner(0));
  } else {
    PacketTrace<any, false, D, Probe>(bvh, packet, bundle, limits, probe).run(WideChild::inner(0));
  }
}

/// Traces the lanes of `packet`, those of like signs together.
template <bool any, class D, class Probe>
void trace_packet(const WideBvh& bvh, Packet<D>& packet, const TogetherLimits& limits,
                  Probe& probe) {
  const D d;
  unsigned alive = packet.alive();
  while (alive != 0) {
    const unsigned which = packet.like(std::countr_zero(alive)) & alive;
    const Bundle bundle = bundle_of(packet, which);
    if (which == packet.alive()) {
      trace_alike<any>(bvh, packet, bundle, limits, probe);
      return;
    }
    Packet<D> part = packet;
    const hn::Mask<D> mask = lanes_of(d, which);
    part.t = hn::IfThenElse(mask, packet.t, hn::Set(d, -1.0f));
    trace_alike<any>(bvh, part, bundle, limits, probe);
    const hn::Rebind<std::uint32_t, D> du;
    packet.t = hn::IfThenElse(mask, part.t, packet.t);
    packet.u = hn::IfThenElse(mask, part.u, packet.u);
    packet.v = hn::IfThenElse(mask, part.v, packet.v);
    packet.triangle = hn::IfThenElse(hn::RebindMask(du, mask), part.triangle, packet.triangle);
    alive &= ~which;
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
