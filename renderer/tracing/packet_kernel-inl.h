/// The triangle test on vectors: lane for lane the operations of intersection.hpp, in their order,
/// so that every width and instruction set gives the bits of the scalar one. Included once per
/// instruction set.
#if defined(IRT_PACKET_KERNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_PACKET_KERNEL_INL
#undef IRT_PACKET_KERNEL_INL
#else
#define IRT_PACKET_KERNEL_INL
#endif

#include <cstdint>
#include <hwy/highway.h>
#include <limits>

#include "renderer/bvh/wide_bvh.hpp"
#include "renderer/tracing/intersection.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A mask's lanes as bits, lane 0 lowest.
template <class D>
HWY_INLINE unsigned bits(D d, hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return static_cast<unsigned>(bytes[0]) | static_cast<unsigned>(bytes[1]) << 8;
}

/// A point or direction per lane.
template <class D>
struct Vectors {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Vectors<D> spread(D d, Vec3 a) {
  return {hn::Set(d, a.x), hn::Set(d, a.y), hn::Set(d, a.z)};
}

/// Lanes from `first` of one corner of a block's triangles.
template <class D>
HWY_INLINE Vectors<D> load(D d, const float (&axes)[3][wide_block], int first) {
  return {hn::Load(d, axes[0] + first), hn::Load(d, axes[1] + first), hn::Load(d, axes[2] + first)};
}

template <class D>
HWY_INLINE Vectors<D> subtract(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

template <class D>
HWY_INLINE hn::Vec<D> dot(const Vectors<D>& a, const Vectors<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class D>
HWY_INLINE Vectors<D> cross(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/// Where lines cross planes of triangles, and which cross the triangles themselves.
template <class D>
struct KernelHit {
  hn::Mask<D> met;
  hn::Vec<D> t, u, v;
};

/// What Möller and Trumbore's test knows of a triangle, given the ray's origin. Rays that share
/// an origin share it.
template <class D>
struct SeenFrom {
  using V = hn::Vec<D>;
  Vectors<D> edge1, edge2;
  Vectors<D> s, q;
  V height;  ///< edge2 . q

  HWY_INLINE SeenFrom(const Vectors<D>& to_b, const Vectors<D>& to_c, const Vectors<D>& from_a,
                      const Vectors<D>& normal, V product)
      : edge1(to_b), edge2(to_c), s(from_a), q(normal), height(product) {}
  HWY_INLINE SeenFrom(const Vectors<D>& to_b, const Vectors<D>& to_c, const Vectors<D>& from_a)
      : edge1(to_b), edge2(to_c), s(from_a), q(cross<D>(from_a, to_b)), height(dot<D>(to_c, q)) {}
  HWY_INLINE SeenFrom(const Vectors<D>& a, const Vectors<D>& b, const Vectors<D>& c,
                      const Vectors<D>& origin)
      : SeenFrom(subtract<D>(b, a), subtract<D>(c, a), subtract<D>(origin, a)) {}
};

/// irt::moller_trumbore per lane.
template <class D>
HWY_INLINE KernelHit<D> moller_trumbore(D d, const SeenFrom<D>& seen, const Vectors<D>& direction) {
  using V = hn::Vec<D>;
  const Vectors<D> p = cross<D>(direction, seen.edge2);
  const V determinant = dot<D>(seen.edge1, p);
  const V sign = hn::And(determinant, hn::SignBit(d));
  const V u = hn::Xor(dot<D>(seen.s, p), sign);
  const V v = hn::Xor(dot<D>(direction, seen.q), sign);
  const V magnitude = hn::Abs(determinant);
  const V zero = hn::Zero(d);
  const hn::Mask<D> sides =
      hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Le(hn::Add(u, v), magnitude));
  const hn::Mask<D> in_range =
      hn::And(hn::Ge(magnitude, hn::Set(d, std::numeric_limits<float>::min())),
              hn::Le(magnitude, hn::Set(d, std::numeric_limits<float>::max())));
  const V inverse = hn::Div(hn::Set(d, 1.0f), magnitude);
  return {hn::And(sides, in_range), hn::Mul(hn::Xor(seen.height, sign), inverse),
          hn::Mul(u, inverse), hn::Mul(v, inverse)};
}

template <class D>
HWY_INLINE KernelHit<D> moller_trumbore(D d, const Vectors<D>& a, const Vectors<D>& b,
                                        const Vectors<D>& c, const Vectors<D>& origin,
                                        const Vectors<D>& direction) {
  return moller_trumbore(d, SeenFrom<D>(a, b, c, origin), direction);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
