/// Many packets through the wide hierarchy together. Included once per target.
#if defined(IRT_WIDE_GROUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_GROUP_INL
#undef IRT_WIDE_GROUP_INL
#else
#define IRT_WIDE_GROUP_INL
#endif

#include <algorithm>
#include <bit>
#include <cstdint>

#include "renderer/bvh/wide/packet-inl.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// Packets whose rays' directions have the same signs, traced side by side (Overbeck,
/// Ramamoorthi and Mark 2008, "Large ray packets for real-time Whitted ray tracing").
///
/// One test of the bounds of all rays culls most of a node's children; each that is left is tested
/// by every packet when its turn comes, and the packets that miss it are left out below. Where few
/// packets are left they go on alone.
template <int N, bool one_origin>
class GroupTrace {
  using F = Floats<N>;

 public:
  GroupTrace(const WideBvh& bvh, Packet<N>* packets, unsigned members, const Bundle& bundle,
             const WideQuery& query)
      : bvh_(bvh),
        packets_(packets),
        members_(members),
        bundle_(bundle),
        test_(bundle),
        query_(query) {
    for (std::uint32_t k = 0; k < most_in_group; ++k) {
      limit_[k] = (members >> k & 1) != 0 ? most_of(packets[k].t) : -1.0f;
    }
    update_limit();
  }

  void run() {
    Open stack[most_waiting];
    int top = 0;
    push_children(0, members_, stack, top);
    while (top > 0) {
      const Open open = stack[--top];
      if (!(open.entry <= all_limit_)) continue;
      const WideNode& parent = bvh_.nodes[open.parent];
      const unsigned inside = enter(parent, open.slot, open.members);
      if (inside == 0) continue;
      const WideChild child = parent.child[open.slot];
      if (child.is_leaf()) {
        leaf(child, inside);
        if (all_limit_ < 0) return;
        continue;
      }
      if (std::popcount(inside) <= most_lone_packets) {
        alone(child, inside);
        if (all_limit_ < 0) return;
        continue;
      }
      push_children(child.node(), inside, stack, top);
    }
  }

 private:
  /// A child that waits, and the packets that have entered its parent.
  struct Open {
    std::uint32_t parent;
    std::uint16_t slot;
    std::uint16_t members;
    float entry;
  };

  HWY_INLINE void push_children(std::uint32_t index, unsigned members, Open* stack,
                                int& top) const {
    const WideNode& node = bvh_.nodes[index];
    alignas(32) float bound[wide_fanout];
    PlaneDistances distances;
    unsigned entered = test_.enter(node, all_limit_, bound, distances);
    const int bottom = top;
    for (; entered != 0; entered &= entered - 1) {
      const int i = std::countr_zero(entered);
      int at = top++;
      for (; at != bottom && stack[at - 1].entry < bound[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {index, static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(members),
                   bound[i]};
    }
  }

  /// The packets of `members` with a lane that enters the child in `slot` before its hit.
  [[nodiscard]] HWY_INLINE unsigned enter(const WideNode& node, int slot, unsigned members) const {
    const int* const near_row = bundle_.near_row;
    VecOf<F> near{F(node.plane[near_row[0]][slot]), F(node.plane[near_row[1]][slot]),
                  F(node.plane[near_row[2]][slot])};
    VecOf<F> far{F(node.plane[bundle_.far_row(0)][slot]), F(node.plane[bundle_.far_row(1)][slot]),
                 F(node.plane[bundle_.far_row(2)][slot])};
    if constexpr (one_origin) {
      const float* const from = bundle_.near_origin;
      const VecOf<F> origin{F(from[0]), F(from[1]), F(from[2])};
      near = near - origin;
      far = far - origin;
    }
    unsigned inside = 0;
    for (; members != 0; members &= members - 1) {
      const int k = std::countr_zero(members);
      const Packet<N>& packet = packets_[k];
      const LaneSlab<N> slab = one_origin ? LaneSlab<N>(near, far, packet.inverse)
                                          : LaneSlab<N>(near - packet.line.origin,
                                                        far - packet.line.origin, packet.inverse);
      inside |= static_cast<unsigned>(any(slab.reaches(packet.t))) << k;
    }
    return inside;
  }

  void leaf(WideChild child, unsigned inside) {
    query_.clock_starts();
    update_limits(
        query_.code->leaf<N>(one_origin)(bvh_.leaf(child), bundle_, query_.any, packets_, inside));
    query_.clock_stops();
  }

  /// The packets of `inside` through the subtree on their own.
  void alone(WideChild child, unsigned inside) {
    const unsigned all = inside;
    for (; inside != 0; inside &= inside - 1) {
      const int k = std::countr_zero(inside);
      if ((bundled_ >> k & 1) == 0) {
        bundles_[k] = bundle_of(packets_[k], packets_[k].alive());
        bundled_ |= 1u << k;
      }
      PacketTrace<N, one_origin>(bvh_, packets_[k], bundles_[k], query_).run(child);
    }
    update_limits(all);
  }

  HWY_INLINE void update_limits(unsigned changed) {
    if (changed == 0) return;
    for (; changed != 0; changed &= changed - 1) {
      const int k = std::countr_zero(changed);
      limit_[k] = most_of(packets_[k].t);
    }
    update_limit();
  }
  HWY_INLINE void update_limit() { all_limit_ = most_of(Floats<most_in_group>::load(limit_)); }

  const WideBvh& bvh_;
  Packet<N>* const packets_;
  const unsigned members_;
  const Bundle& bundle_;
  const BundleTest test_;
  const WideQuery& query_;
  alignas(64) float limit_[most_in_group];  ///< per packet, the largest `t` of its lanes
  float all_limit_ = 0;                     ///< the largest of those
  Bundle bundles_[most_in_group];
  unsigned bundled_ = 0;  ///< the packets whose own bounds are in `bundles_`
};

/// Traces the packets of `members`, whose rays' directions have the same signs.
template <int N>
void trace_alike(const WideBvh& bvh, Packet<N>* packets, unsigned members, const Bundle& bundle,
                 const WideQuery& query) {
  if (bundle.one_origin()) {
    GroupTrace<N, true>(bvh, packets, members, bundle, query).run();
  } else {
    GroupTrace<N, false>(bvh, packets, members, bundle, query).run();
  }
}

/// Rays of packets whose directions differ in signs, packed anew by their signs.
template <int N>
class SortedRays {
  using F = Floats<N>;

 public:
  SortedRays() {
    for (OfSigns& rays : of_) rays.count = 0;
  }

  /// Adds those of the lanes `living` of packet number `k`.
  void add(int k, const Packet<N>& packet, unsigned living, const SignLanes& negative) {
    alignas(64) float lanes[rows][N];
    packet.store_rays(lanes);
    for (; living != 0; living &= living - 1) {
      const int lane = std::countr_zero(living);
      const unsigned signs = (negative.of[0] >> lane & 1) | (negative.of[1] >> lane & 1) << 1 |
                             (negative.of[2] >> lane & 1) << 2;
      OfSigns& rays = of_[signs];
      for (int row = 0; row < rows; ++row) rays.value[row][rays.count] = lanes[row][lane];
      rays.from[rays.count++] = static_cast<std::uint16_t>(k * N + lane);
    }
  }

  /// Traces them and puts what they meet into the lanes of `packets` that they are from.
  void trace(const WideBvh& bvh, Packet<N>* packets, const WideQuery& query) {
    for (OfSigns& rays : of_) {
      if (rays.count == 0) continue;
      Packet<N> sorted[most_in_group];
      BundleBounds<N> bounds;
      const std::uint32_t count = (rays.count + N - 1) / N;
      for (std::uint32_t k = 0; k < count; ++k) {
        load(rays, k * N, sorted[k]);
        bounds.add(sorted[k], sorted[k].alive());
      }
      trace_alike<N>(bvh, sorted, (1u << count) - 1, bounds.bundle(), query);
      for (std::uint32_t k = 0; k < count; ++k) put_back(rays, k * N, sorted[k], packets);
    }
  }

 private:
  static constexpr int rows = Packet<N>::ray_rows;
  static constexpr std::uint32_t most = most_in_group * N;
  struct OfSigns {
    std::uint32_t count;
    std::uint16_t from[most];  ///< packet times N plus lane
    alignas(64) float value[rows][most];
  };

  static void load(OfSigns& rays, std::uint32_t first, Packet<N>& packet) {
    for (std::uint32_t i = rays.count; i < first + N; ++i) {
      for (auto& row : rays.value) row[i] = 1;
    }
    const auto row = [&](int i) HWY_ATTR { return F::load(rays.value[i] + first); };
    packet.line = {{row(0), row(1), row(2)}, {row(3), row(4), row(5)}, row(9)};
    packet.inverse = {row(6), row(7), row(8)};
    const std::uint32_t left = std::min<std::uint32_t>(rays.count - first, N);
    packet.t = select(truths<N>((1u << left) - 1), packet.line.end, F(-1.0f));
    packet.u = packet.v = F(0.0f);
    packet.triangle = Indices<N>(no_triangle);
  }

  static void put_back(const OfSigns& rays, std::uint32_t first, const Packet<N>& packet,
                       Packet<N>* packets) {
    alignas(64) float t[N], u[N], v[N];
    alignas(64) std::uint32_t triangle[N];
    packet.t.store(t);
    packet.u.store(u);
    packet.v.store(v);
    packet.triangle.store(triangle);
    for (unsigned met = packet.met().bits(); met != 0; met &= met - 1) {
      const int lane = std::countr_zero(met);
      const std::uint32_t from = rays.from[first + static_cast<std::uint32_t>(lane)];
      packets[from / N].put(static_cast<int>(from % N),
                            {t[lane], u[lane], v[lane], triangle[lane]});
    }
  }

  OfSigns of_[8];
};

/// Traces up to `most_in_group` packets, rays of like signs together. Packets of mixed signs are
/// packed anew.
template <int N>
void trace_group(const WideBvh& bvh, Packet<N>* packets, std::uint32_t count,
                 const WideQuery& query) {
  unsigned of_signs[8] = {};
  BundleBounds<N> bounds[8];
  SortedRays<N> sorted;
  for (std::uint32_t k = 0; k < count; ++k) {
    Packet<N>& packet = packets[k];
    const Truths<N> alive = packet.alive();
    const unsigned living = alive.bits();
    if (living == 0) continue;
    unsigned signs = 0;
    bool mixed = false;
    const SignLanes negative = packet.negative_lanes();
    for (int axis = 0; axis < 3; ++axis) {
      const unsigned here = negative.of[axis] & living;
      if (here != 0) signs |= 1u << axis;
      mixed |= here != 0 && here != living;
    }
    if (mixed) {
      sorted.add(static_cast<int>(k), packet, living, negative);
    } else {
      of_signs[signs] |= 1u << k;
      bounds[signs].add(packet, alive);
    }
  }
  for (int signs = 0; signs < 8; ++signs) {
    const unsigned members = of_signs[signs];
    if (members == 0) continue;
    trace_alike<N>(bvh, packets, members, bounds[signs].bundle(), query);
  }
  sorted.trace(bvh, packets, query);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
