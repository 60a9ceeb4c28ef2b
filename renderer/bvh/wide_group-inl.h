/// Many packets through the wide hierarchy together. Included once per instruction set.
#if defined(IRT_WIDE_GROUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_GROUP_INL
#undef IRT_WIDE_GROUP_INL
#else
#define IRT_WIDE_GROUP_INL
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>

#include "renderer/bvh/wide_bvh.hpp"
#include "renderer/bvh/wide_packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Packets whose rays' directions have the same signs, traced side by side (Overbeck,
/// Ramamoorthi and Mark 2008, "Large ray packets for real-time Whitted ray tracing").
///
/// One test of the bounds of all rays culls most of a node's children; each that is left is tested
/// by every packet when its turn comes, and the packets that miss it are left out below. Where few
/// packets are left they go on alone.
template <bool any, bool one_origin, class D, class Probe>
class GroupTrace {
  using V = hn::Vec<D>;
  static constexpr int lanes = Packet<D>::lanes;

 public:
  static constexpr int most = 16;

  GroupTrace(const WideBvh& bvh, Packet<D>* packets, unsigned members, const Bundle& bundle,
             const TogetherLimits& limits, Probe& probe)
      : bvh_(bvh),
        packets_(packets),
        members_(members),
        bundle_(bundle),
        test_(bundle),
        limits_(limits),
        probe_(probe) {
    const D d;
    for (int k = 0; k < most; ++k) {
      limit_[k] = (members >> k & 1) != 0 ? hn::GetLane(hn::MaxOfLanes(d, packets[k].t)) : -1.0f;
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
        probe_.test_begins();
        leaf(child, inside);
        probe_.test_ends();
        if (all_limit_ < 0) return;
        continue;
      }
      if (std::popcount(inside) <= limits_.packets) {
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
  HWY_INLINE unsigned enter(const WideNode& node, int slot, unsigned members) const {
    const D d;
    Vectors<D> near{hn::Set(d, node.plane[bundle_.near_row[0]][slot]),
                    hn::Set(d, node.plane[bundle_.near_row[1]][slot]),
                    hn::Set(d, node.plane[bundle_.near_row[2]][slot])};
    Vectors<D> far{hn::Set(d, node.plane[bundle_.far_row(0)][slot]),
                   hn::Set(d, node.plane[bundle_.far_row(1)][slot]),
                   hn::Set(d, node.plane[bundle_.far_row(2)][slot])};
    if constexpr (one_origin) {
      const Vectors<D> origin =
          spread(d, {bundle_.near_origin[0], bundle_.near_origin[1], bundle_.near_origin[2]});
      near = subtract<D>(near, origin);
      far = subtract<D>(far, origin);
    }
    unsigned inside = 0;
    for (; members != 0; members &= members - 1) {
      const int k = std::countr_zero(members);
      const Packet<D>& packet = packets_[k];
      const Vectors<D> to_near = one_origin ? near : subtract<D>(near, packet.origin);
      const Vectors<D> to_far = one_origin ? far : subtract<D>(far, packet.origin);
      const LaneSlab<D> slab(
          d, hn::Mul(to_near.x, packet.inverse.x), hn::Mul(to_near.y, packet.inverse.y),
          hn::Mul(to_near.z, packet.inverse.z), hn::Mul(to_far.x, packet.inverse.x),
          hn::Mul(to_far.y, packet.inverse.y), hn::Mul(to_far.z, packet.inverse.z));
      const hn::Mask<D> in = hn::Le(slab.entry, hn::Min(slab.exit, packet.t));
      inside |= static_cast<unsigned>(!hn::AllFalse(d, in)) << k;
    }
    return inside;
  }

  /// The leaf's triangles one after the other, each against the packets inside.
  HWY_INLINE void leaf(WideChild child, unsigned inside) {
    const D d;
    const WideBlock* block = bvh_.blocks.data() + child.first_block();
    unsigned changed = 0;
    for (std::uint32_t first = 0; first < child.count(); first += wide_block, ++block) {
      const BlockSeen<one_origin> seen(*block, bundle_.near_origin);
      BlockBoxes boxes(*block);
      const std::uint32_t count = std::min<std::uint32_t>(wide_block, child.count() - first);
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto triangle = [&](const Vectors<D>& origin) HWY_ATTR {
          return seen.of(d, static_cast<int>(i), *block, origin);
        };
        // With one origin this is all there is to it.
        const SeenFrom<D> shared = triangle(packets_[std::countr_zero(inside)].origin);
        for (unsigned left = inside; left != 0; left &= left - 1) {
          const int k = std::countr_zero(left);
          Packet<D>& packet = packets_[k];
          const KernelHit<D> hit =
              moller_trumbore(d, one_origin ? shared : triangle(packet.origin), packet.direction);
          if (hn::AllFalse(d, hit.met)) continue;
          if (meet_lanes<any>(boxes, static_cast<int>(i), hit, bundle_, packet)) {
            changed |= 1u << k;
          }
        }
      }
    }
    update_limits(changed);
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
      PacketTrace<any, one_origin, D, Probe>(bvh_, packets_[k], bundles_[k], limits_, probe_)
          .run(child);
    }
    update_limits(all);
  }

  HWY_INLINE void update_limits(unsigned changed) {
    const D d;
    if (changed == 0) return;
    for (; changed != 0; changed &= changed - 1) {
      const int k = std::countr_zero(changed);
      limit_[k] = hn::GetLane(hn::MaxOfLanes(d, packets_[k].t));
    }
    update_limit();
  }
  HWY_INLINE void update_limit() {
    const D d;
    V all = hn::Load(d, limit_);
    for (std::size_t i = hn::Lanes(d); i < most; i += hn::Lanes(d)) {
      all = hn::Max(all, hn::Load(d, limit_ + i));
    }
    all_limit_ = hn::GetLane(hn::MaxOfLanes(d, all));
  }

  const WideBvh& bvh_;
  Packet<D>* const packets_;
  const unsigned members_;
  const Bundle& bundle_;
  const BundleTest test_;
  const TogetherLimits& limits_;
  Probe& probe_;
  alignas(64) float limit_[most];  ///< per packet, the largest `t` of its lanes
  float all_limit_ = 0;            ///< the largest of those
  Bundle bundles_[most];
  unsigned bundled_ = 0;  ///< the packets whose own bounds are in `bundles_`
};

/// The bounds of the live lanes of `members`, whose directions have the same signs.
template <class D>
HWY_INLINE Bundle bundle_of(const Packet<D>* packets, unsigned members) {
  const D d;
  using V = hn::Vec<D>;
  const V inf = hn::Set(d, std::numeric_limits<float>::infinity());
  V least[6], most[6];
  for (int i = 0; i < 6; ++i) {
    least[i] = inf;
    most[i] = hn::Neg(inf);
  }
  for (; members != 0; members &= members - 1) {
    const Packet<D>& packet = packets[std::countr_zero(members)];
    const hn::Mask<D> alive = hn::Ge(packet.t, hn::Zero(d));
    const V values[6] = {packet.origin.x,  packet.origin.y,  packet.origin.z,
                         packet.inverse.x, packet.inverse.y, packet.inverse.z};
    for (int i = 0; i < 6; ++i) {
      least[i] = hn::Min(least[i], hn::IfThenElse(alive, values[i], inf));
      most[i] = hn::Max(most[i], hn::IfThenElse(alive, values[i], hn::Neg(inf)));
    }
  }
  Bundle bundle;
  for (int axis = 0; axis < 3; ++axis) {
    bundle.least_inverse[axis] = hn::GetLane(hn::MinOfLanes(d, least[axis + 3]));
    bundle.most_inverse[axis] = hn::GetLane(hn::MaxOfLanes(d, most[axis + 3]));
    const float low = hn::GetLane(hn::MinOfLanes(d, least[axis]));
    const float high = hn::GetLane(hn::MaxOfLanes(d, most[axis]));
    const bool negative = bundle.most_inverse[axis] < 0;
    bundle.near_origin[axis] = negative ? low : high;
    bundle.far_origin[axis] = negative ? high : low;
    bundle.near_row[axis] = axis + (negative ? 3 : 0);
  }
  return bundle;
}

/// Traces up to GroupTrace::most packets: those of like signs together, those of mixed ones alone.
template <bool any, class D, class Probe>
void trace_group(const WideBvh& bvh, Packet<D>* packets, std::uint32_t count,
                 const TogetherLimits& limits, Probe& probe) {
  unsigned of_signs[8] = {};
  for (std::uint32_t k = 0; k < count; ++k) {
    const Packet<D>& packet = packets[k];
    const unsigned alive = packet.alive();
    if (alive == 0) continue;
    unsigned signs = 0;
    bool mixed = false;
    const SignLanes negative = packet.negative_lanes();
    for (int axis = 0; axis < 3; ++axis) {
      const unsigned here = negative.of[axis] & alive;
      if (here != 0) signs |= 1u << axis;
      mixed |= here != 0 && here != alive;
    }
    if (mixed) {
      trace_packet<any>(bvh, packets[k], limits, probe);
    } else {
      of_signs[signs] |= 1u << k;
    }
  }
  for (const unsigned members : of_signs) {
    if (members == 0) continue;
    const Bundle bundle = bundle_of(packets, members);
    if (bundle.one_origin()) {
      GroupTrace<any, true, D, Probe>(bvh, packets, members, bundle, limits, probe).run();
    } else {
      GroupTrace<any, false, D, Probe>(bvh, packets, members, bundle, limits, probe).run();
    }
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
