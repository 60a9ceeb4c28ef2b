/// A packet: N rays side by side, with what they have met so far, and the bounds of many rays.
/// Included once per target.
#if defined(IRT_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_PACKET_INL
#undef IRT_PACKET_INL
#else
#define IRT_PACKET_INL
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// irt::finite_inverse per lane.
template <int N>
HWY_INLINE Floats<N> finite_inverse(const Floats<N>& x) {
  const Floats<N> most(std::numeric_limits<float>::max());
  const Floats<N> inverse = Floats<N>(1.0f) / x;
  return select(magnitude(inverse) <= most, inverse, flip_sign(most, x));
}

/// irt::last_below per lane.
template <int N>
HWY_INLINE Floats<N> last_below(const Floats<N>& t_max) {
  using Tag = typename Floats<N>::Tag;
  const hn::RebindToSigned<Tag> integers;
  Floats<N> below;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    below.part[i] =
        hn::BitCast(Tag(), hn::Sub(hn::BitCast(integers, t_max.part[i]), hn::Set(integers, 1)));
  }
  return select(t_max > Floats<N>(std::numeric_limits<float>::denorm_min()), below,
                Floats<N>(-1.0f));
}

/// Bounds of some rays' origins and inverse directions, which have the same signs. What they give
/// for a box bounds what `slab` computes for every one of the rays: rounding is monotone.
struct Bundle {
  float near_origin[3], far_origin[3];  ///< the origin that gives the first entry, the last exit
  float least_inverse[3], most_inverse[3];
  int near_row[3];  ///< of WideNode::plane

  [[nodiscard]] bool one_origin() const {
    return near_origin[0] == far_origin[0] && near_origin[1] == far_origin[1] &&
           near_origin[2] == far_origin[2];
  }
  [[nodiscard]] int far_row(int axis) const { return near_row[axis] < 3 ? axis + 3 : axis; }
};

/// Per axis, the lanes whose direction is negative.
struct SignLanes {
  unsigned of[3];
};

/// Rays in lanes. A lane without a ray, or whose ray meets nothing, has a `t` of -1: no box is
/// entered before that.
template <int N>
struct Packet {
  using F = Floats<N>;

  LineOf<F> line;
  VecOf<F> inverse;
  F t;  ///< the nearest hit so far or the largest distance that counts
  F u, v;
  Indices<N> triangle;  ///< the number of that hit, or no_triangle

  /// Takes the rays from `first` on. Lanes past the last one are without a ray.
  HWY_INLINE void load(const Rays& rays, std::uint32_t first) {
    line = {{F::load(&rays.origin_x[first]), F::load(&rays.origin_y[first]),
             F::load(&rays.origin_z[first])},
            {F::load(&rays.direction_x[first]), F::load(&rays.direction_y[first]),
             F::load(&rays.direction_z[first])},
            last_below(F::load(&rays.t_max[first]))};
    const VecOf<F>&o = line.origin, &d = line.direction;
    const F none(0.0f);
    inverse = {finite_inverse(d.x), finite_inverse(d.y), finite_inverse(d.z)};
    const F zero =
        (o.x * none + d.x * none) + (o.y * none + d.y * none) + (o.z * none + d.z * none);
    const std::uint32_t left = std::min<std::uint32_t>(rays.size - first, N);
    const Truths<N> sound = both(zero == none, truths<N>((1u << left) - 1));
    t = select(sound, line.end, F(-1.0f));
    u = v = none;
    triangle = Indices<N>(no_triangle);
  }

  /// Stores what makes the rays, row by row: origin, direction, inverse, end.
  static constexpr int ray_rows = 10;
  HWY_INLINE void store_rays(float (&rows)[ray_rows][N]) const {
    const VecOf<F>&o = line.origin, &d = line.direction, &i = inverse;
    const F* const values[] = {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z, &i.x, &i.y, &i.z, &line.end};
    for (int row = 0; row < ray_rows; ++row) values[row]->store(rows[row]);
  }

  /// The lanes that have met a triangle.
  [[nodiscard]] HWY_INLINE Truths<N> met() const { return triangle != Indices<N>(no_triangle); }

  /// The lanes with a ray that may meet something.
  [[nodiscard]] HWY_INLINE Truths<N> alive() const { return t >= F(0.0f); }

  [[nodiscard]] HWY_INLINE SignLanes negative_lanes() const {
    const F zero(0.0f);
    return {{(inverse.x < zero).bits(), (inverse.y < zero).bits(), (inverse.z < zero).bits()}};
  }

  /// Makes `hit` the nearest of `lane`.
  HWY_INLINE void put(int lane, const Hit& hit) {
    const Truths<N> here = truths<N>(1u << lane);
    t = select(here, F(hit.t), t);
    u = select(here, F(hit.u), u);
    v = select(here, F(hit.v), v);
    triangle = select(here, Indices<N>(hit.triangle), triangle);
  }
};

/// Packets at most in a group; a set of them is a number of so many bits.
inline constexpr std::uint32_t most_in_group = 16;

/// Gathers a bundle from rays whose directions have the same signs.
template <int N>
class BundleBounds {
  using F = Floats<N>;

 public:
  BundleBounds() {
    for (int i = 0; i < 6; ++i) {
      least_[i] = F(infinity);
      most_[i] = F(-infinity);
    }
  }

  HWY_INLINE void add(const Packet<N>& packet, const Truths<N>& lanes) {
    const VecOf<F>&o = packet.line.origin, &d = packet.inverse;
    const F values[6] = {o.x, o.y, o.z, d.x, d.y, d.z};
    for (int i = 0; i < 6; ++i) {
      least_[i] = lesser(least_[i], select(lanes, values[i], F(infinity)));
      most_[i] = greater(most_[i], select(lanes, values[i], F(-infinity)));
    }
  }

  [[nodiscard]] HWY_INLINE Bundle bundle() const {
    Bundle bundle;
    for (int axis = 0; axis < 3; ++axis) {
      bundle.least_inverse[axis] = least_of(least_[axis + 3]);
      bundle.most_inverse[axis] = most_of(most_[axis + 3]);
      const bool negative = bundle.most_inverse[axis] < 0;
      const float low = least_of(least_[axis]), high = most_of(most_[axis]);
      bundle.near_origin[axis] = negative ? low : high;
      bundle.far_origin[axis] = negative ? high : low;
      bundle.near_row[axis] = axis + (negative ? 3 : 0);
    }
    return bundle;
  }

 private:
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  F least_[6], most_[6];
};

/// The bounds of the lanes of `which`.
template <int N>
HWY_INLINE Bundle bundle_of(const Packet<N>& packet, const Truths<N>& which) {
  BundleBounds<N> bounds;
  bounds.add(packet, which);
  return bounds.bundle();
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
