/// A packet of rays through the wide hierarchy. Included once per target.
#if defined(IRT_WIDE_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_PACKET_INL
#undef IRT_WIDE_PACKET_INL
#else
#define IRT_WIDE_PACKET_INL
#endif

#include <bit>
#include <cstdint>

#include "renderer/bvh/wide/single-inl.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/tracing/packet-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// What depends on the kernel. It is called through pointers, so that the code that walks the
/// hierarchy with packets exists once for all kernels.
template <int N>
using MeetPackets = unsigned (*)(const WideLeaf& leaf, const Bundle& bundle, bool any_hit,
                                 Packet<N>* packets, unsigned inside);
using TraceSingle = void (*)(const WideBvh& bvh, const TraversalRay& ray, Waiting start,
                             TickProbe* probe, Hit& best);
struct KernelCode {
  TraceSingle single[2];   ///< for the first and for any hit
  MeetPackets<4> four[2];  ///< without and with a common origin
  MeetPackets<8> eight[2];
  MeetPackets<16> sixteen[2];

  template <int N>
  [[nodiscard]] MeetPackets<N> leaf(bool one_origin) const {
    if constexpr (N == 4) return four[one_origin];
    if constexpr (N == 8) return eight[one_origin];
    if constexpr (N == 16) return sixteen[one_origin];
  }
};

template <class Kernel>
inline constexpr KernelCode kernel_code{
    {trace_single<Kernel, false>, trace_single<Kernel, true>},
    {meet_leaf<Kernel, 4, false>, meet_leaf<Kernel, 4, true>},
    {meet_leaf<Kernel, 8, false>, meet_leaf<Kernel, 8, true>},
    {meet_leaf<Kernel, 16, false>, meet_leaf<Kernel, 16, true>},
};

/// What a traversal is to find, and how.
struct WideQuery {
  const KernelCode* code;
  bool any;          ///< any hit will do
  TickProbe* probe;  ///< null: nobody asks for the time

  HWY_INLINE void clock_starts() const {
    if (probe != nullptr) probe->test_begins();
  }
  HWY_INLINE void clock_stops() const {
    if (probe != nullptr) probe->test_ends();
  }
};

/// Distances of a node's planes from a bundle's origin, along the axes: near x, y, z, then far.
struct alignas(64) PlaneDistances {
  float of[6][wide_fanout];
};

/// A bundle's bounds against the eight boxes of a node at once.
class BundleTest {
 public:
  explicit BundleTest(const Bundle& bundle) : bundle_(bundle) {}

  /// The children that some ray may enter at or before `limit`, as bits, with a bound of the entry.
  HWY_INLINE unsigned enter(const WideNode& node, float limit, float* HWY_RESTRICT entry,
                            PlaneDistances& distances) const {
    const NodeFloats near = greater(greater(first(node, 0, distances), first(node, 1, distances)),
                                    greater(first(node, 2, distances), NodeFloats(0.0f)));
    const NodeFloats far = lesser(lesser(last(node, 0, distances), last(node, 1, distances)),
                                  last(node, 2, distances));
    near.store(entry);
    return (near <= lesser(far * NodeFloats(exit_widening), NodeFloats(limit))).bits();
  }

 private:
  HWY_INLINE NodeFloats first(const WideNode& node, int axis, PlaneDistances& distances) const {
    const NodeFloats distance = NodeFloats::load(node.plane[bundle_.near_row[axis]]) -
                                NodeFloats(bundle_.near_origin[axis]);
    distance.store(distances.of[axis]);
    return lesser(distance * NodeFloats(bundle_.least_inverse[axis]),
                  distance * NodeFloats(bundle_.most_inverse[axis]));
  }
  HWY_INLINE NodeFloats last(const WideNode& node, int axis, PlaneDistances& distances) const {
    const NodeFloats distance =
        NodeFloats::load(node.plane[bundle_.far_row(axis)]) - NodeFloats(bundle_.far_origin[axis]);
    distance.store(distances.of[axis + 3]);
    return greater(distance * NodeFloats(bundle_.least_inverse[axis]),
                   distance * NodeFloats(bundle_.most_inverse[axis]));
  }

  const Bundle bundle_;
};

/// Where lanes enter and leave child `i` of a node whose planes' distances from the common origin
/// are known.
template <int N>
HWY_INLINE LaneSlab<N> lane_slab(const PlaneDistances& distances, int i,
                                 const VecOf<Floats<N>>& inverse) {
  using F = Floats<N>;
  return {{F(distances.of[0][i]), F(distances.of[1][i]), F(distances.of[2][i])},
          {F(distances.of[3][i]), F(distances.of[4][i]), F(distances.of[5][i])},
          inverse};
}

/// How many must be left of a packet or a group for it to go on as one. Measured on the three
/// scenes: from 1 to 4 little changes.
inline constexpr int most_single_lanes = 2;  ///< in an inner node, so many go on as single rays
inline constexpr int most_lone_packets = 2;  ///< so many packets leave their group

/// One packet whose rays' directions have the same signs. In every node the bounds of all its rays
/// cull children first (Boulos, Wald and Shirley 2006), then the lanes test the boxes that are
/// left. Where few lanes are left they go on as single rays (Benthin, Wald, Woop, Ernst and Mark
/// 2012, "Combining single and packet-ray tracing for arbitrary ray distributions").
///
/// With `one_origin`, all rays start in one point, and what they share of each test is computed
/// once.
template <int N, bool one_origin>
class PacketTrace {
  using F = Floats<N>;

 public:
  HWY_INLINE PacketTrace(const WideBvh& bvh, Packet<N>& packet, const Bundle& bundle,
                         const WideQuery& query)
      : bvh_(bvh), packet_(packet), bundle_(bundle), test_(bundle), query_(query) {
    update_limit();
  }

  void run(WideChild start) {
    const int far_row[3] = {bundle_.far_row(0), bundle_.far_row(1), bundle_.far_row(2)};
    const VecOf<F> origin = packet_.line.origin, inverse = packet_.inverse;
    Waiting stack[most_waiting];
    alignas(64) float entries[most_waiting][N];
    int top = 0;
    stack[top] = {start, 0};
    F(0.0f).store(entries[top++]);
    while (top > 0) {
      --top;
      if (!(stack[top].entry <= limit_)) continue;
      const WideChild child = stack[top].child;
      const unsigned inside = (F::load(entries[top]) <= packet_.t).bits();
      if (inside == 0) continue;
      if (child.is_leaf()) {
        leaf(child);
        if (limit_ < 0) return;
        continue;
      }
      if (std::popcount(inside) <= most_single_lanes) {
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
        const LaneSlab<N> slab =
            one_origin ? lane_slab<N>(distances, i, inverse)
                       : LaneSlab<N>(origin, inverse, corner(node, i, bundle_.near_row),
                                     corner(node, i, far_row));
        const Truths<N> in = slab.reaches(packet_.t);
        if (!any(in)) continue;
        int at = top++;
        for (; at != bottom && stack[at - 1].entry < bound[i]; --at) {
          stack[at] = stack[at - 1];
          F::load(entries[at - 1]).store(entries[at]);
        }
        stack[at] = {node.child[i], bound[i]};
        select(in, slab.entry, F(WideNode::infinity)).store(entries[at]);
      }
    }
  }

 private:
  static HWY_INLINE Vec3 corner(const WideNode& node, int i, const int (&rows)[3]) {
    return {node.plane[rows[0]][i], node.plane[rows[1]][i], node.plane[rows[2]][i]};
  }

  HWY_INLINE void update_limit() { limit_ = most_of(packet_.t); }

  void leaf(WideChild child) {
    query_.clock_starts();
    const unsigned changed =
        query_.code->leaf<N>(one_origin)(bvh_.leaf(child), bundle_, query_.any, &packet_, 1);
    if (changed != 0) update_limit();
    query_.clock_stops();
  }

  /// The lanes of `which` below `child`, each on its own.
  void singly(WideChild child, unsigned which) {
    alignas(64) float lanes[Packet<N>::ray_rows][N], t[N];
    alignas(64) std::uint32_t triangles[N];
    packet_.store_rays(lanes);
    packet_.t.store(t);
    packet_.triangle.store(triangles);
    bool changed = false;
    for (; which != 0; which &= which - 1) {
      const int lane = std::countr_zero(which);
      TraversalRay ray{Ray{}};
      ray.origin = {lanes[0][lane], lanes[1][lane], lanes[2][lane]};
      ray.direction = {lanes[3][lane], lanes[4][lane], lanes[5][lane]};
      ray.inverse = {lanes[6][lane], lanes[7][lane], lanes[8][lane]};
      ray.limit = lanes[9][lane];
      const Hit before{t[lane], 0, 0, triangles[lane]};
      Hit best = before;
      query_.code->single[query_.any](bvh_, ray, {child, 0}, query_.probe, best);
      if (best.t == before.t && best.triangle == before.triangle) continue;
      packet_.put(lane, {query_.any ? -1.0f : best.t, best.u, best.v, best.triangle});
      changed = true;
    }
    if (changed) update_limit();
  }

  const WideBvh& bvh_;
  Packet<N>& packet_;
  const Bundle& bundle_;
  BundleTest test_;
  const WideQuery& query_;
  float limit_ = 0;  ///< the largest `t` of any lane
};

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
