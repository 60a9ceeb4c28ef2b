/// A packet: as many rays as a vector has lanes, with what they have met so far. Included once per
/// instruction set.
#if defined(IRT_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_PACKET_INL
#undef IRT_PACKET_INL
#else
#define IRT_PACKET_INL
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>

#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/packet_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// irt::finite_inverse per lane.
template <class D>
HWY_INLINE hn::Vec<D> finite_inverse(D d, hn::Vec<D> x) {
  const hn::Vec<D> most = hn::Set(d, std::numeric_limits<float>::max());
  const hn::Vec<D> inverse = hn::Div(hn::Set(d, 1.0f), x);
  return hn::IfThenElse(hn::Le(hn::Abs(inverse), most), inverse, hn::CopySign(most, x));
}

/// irt::last_below per lane.
template <class D>
HWY_INLINE hn::Vec<D> last_below(D d, hn::Vec<D> t_max) {
  const hn::Rebind<std::int32_t, D> di;
  const hn::Vec<D> below = hn::BitCast(d, hn::Sub(hn::BitCast(di, t_max), hn::Set(di, 1)));
  const hn::Vec<D> least = hn::Set(d, std::numeric_limits<float>::denorm_min());
  return hn::IfThenElse(hn::Gt(t_max, least), below, hn::Set(d, -1.0f));
}

/// Bounds of some rays' origins and inverse directions, which have the same signs. What they give
/// for a box bounds what `slab` computes for every one of the rays: rounding is monotone.
struct Bundle {
  float near_origin[3], far_origin[3];  ///< the origin that gives the first entry, the last exit
  float least_inverse[3], most_inverse[3];
  int near_row[3];  ///< of WideNode::plane

  bool one_origin() const {
    return near_origin[0] == far_origin[0] && near_origin[1] == far_origin[1] &&
           near_origin[2] == far_origin[2];
  }
  int far_row(int axis) const { return near_row[axis] < 3 ? axis + 3 : axis; }
};

/// Per axis, the lanes whose direction is negative.
struct SignLanes {
  unsigned of[3];
};

/// Rays in lanes. A lane without a ray, or whose ray meets nothing, has a `t` of -1: no box is
/// entered before that.
template <class D>
struct Packet {
  using V = hn::Vec<D>;
  static constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));

  Vectors<D> origin, direction, inverse;
  V t;  ///< the nearest hit so far or the largest distance that counts
  V u, v;
  hn::Vec<hn::Rebind<std::uint32_t, D>> triangle;  ///< the number of that hit, or no_triangle

  /// Takes the rays from `first` on. Lanes past the last one are without a ray.
  HWY_INLINE void load(const Rays& rays, std::uint32_t first) {
    const D d;
    origin = {hn::Load(d, &rays.origin_x[first]), hn::Load(d, &rays.origin_y[first]),
              hn::Load(d, &rays.origin_z[first])};
    direction = {hn::Load(d, &rays.direction_x[first]), hn::Load(d, &rays.direction_y[first]),
                 hn::Load(d, &rays.direction_z[first])};
    inverse = {finite_inverse(d, direction.x), finite_inverse(d, direction.y),
               finite_inverse(d, direction.z)};
    const V none = hn::Zero(d);
    const V zero = hn::Add(hn::Add(hn::Add(hn::Mul(origin.x, none), hn::Mul(direction.x, none)),
                                   hn::Add(hn::Mul(origin.y, none), hn::Mul(direction.y, none))),
                           hn::Add(hn::Mul(origin.z, none), hn::Mul(direction.z, none)));
    const hn::Mask<D> sound = hn::And(hn::Eq(zero, none), hn::FirstN(d, rays.size - first));
    t = hn::IfThenElse(sound, last_below(d, hn::Load(d, &rays.t_max[first])), hn::Set(d, -1.0f));
    u = v = none;
    triangle = hn::Set(hn::Rebind<std::uint32_t, D>(), no_triangle);
  }

  /// The lanes that have met a triangle.
  HWY_INLINE unsigned met() const {
    const hn::Rebind<std::uint32_t, D> du;
    return bits(D(), hn::RebindMask(D(), hn::Ne(triangle, hn::Set(du, no_triangle))));
  }

  /// The lanes with a ray that may meet something.
  HWY_INLINE unsigned alive() const { return bits(D(), hn::Ge(t, hn::Zero(D()))); }

  /// Lanes with a negative direction.
  HWY_INLINE SignLanes negative_lanes() const {
    const D d;
    const V zero = hn::Zero(d);
    return {{bits(d, hn::Lt(inverse.x, zero)), bits(d, hn::Lt(inverse.y, zero)),
             bits(d, hn::Lt(inverse.z, zero))}};
  }

  /// Lanes whose direction has the signs of that in `lane`.
  HWY_INLINE unsigned like(int lane) const {
    unsigned same = (1u << lanes) - 1;
    for (const unsigned negative : negative_lanes().of) {
      same &= (negative >> lane & 1) != 0 ? negative : ~negative;
    }
    return same;
  }
};

/// A mask of the lanes whose bit is set.
template <class D>
HWY_INLINE hn::Mask<D> lanes_of(D d, unsigned which) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(which),
                                 static_cast<std::uint8_t>(which >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

/// The bounds of the lanes of `which`, whose directions have the signs of that in `lane`.
template <class D>
HWY_INLINE Bundle bundle_of(const Packet<D>& packet, unsigned which) {
  const D d;
  const hn::Mask<D> mask = lanes_of(d, which);
  const hn::Vec<D> inf = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto least = [&](hn::Vec<D> x) {
    return hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(mask, x, inf)));
  };
  const auto most = [&](hn::Vec<D> x) {
    return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(mask, x, hn::Neg(inf))));
  };
  Bundle bundle;
  const hn::Vec<D> origins[3] = {packet.origin.x, packet.origin.y, packet.origin.z};
  const hn::Vec<D> inverses[3] = {packet.inverse.x, packet.inverse.y, packet.inverse.z};
  for (int axis = 0; axis < 3; ++axis) {
    bundle.least_inverse[axis] = least(inverses[axis]);
    bundle.most_inverse[axis] = most(inverses[axis]);
    const bool negative = bundle.most_inverse[axis] < 0;
    const float low = least(origins[axis]), high = most(origins[axis]);
    bundle.near_origin[axis] = negative ? low : high;
    bundle.far_origin[axis] = negative ? high : low;
    bundle.near_row[axis] = axis + (negative ? 3 : 0);
  }
  return bundle;
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
