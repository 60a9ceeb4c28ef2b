/// Many hits' surfaces side by side: `surface_at` lane by lane, with its bits. Included once per
/// target.
#if defined(IRT_SURFACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_SURFACES_INL
#undef IRT_SURFACES_INL
#else
#define IRT_SURFACES_INL
#endif

#include <algorithm>
#include <cstdint>
#include <limits>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/kernels-inl.hpp"
#include "renderer/tracing/rays.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// As many lanes as the target's vectors have, 16 at most.
inline constexpr int lanes = FloatLayout<16>::per_part;
using Lanes = Floats<lanes>;
using Lanes3 = VecOf<Lanes>;

HWY_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Lanes3 operator*(const Lanes3& a, const Lanes3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
HWY_INLINE Lanes3 operator*(const Lanes3& a, const Lanes& s) {
  return {a.x * s, a.y * s, a.z * s};
}
HWY_INLINE Lanes3 select(const Truths<lanes>& which, const Lanes3& yes, const Lanes3& no) {
  return {select(which, yes.x, no.x), select(which, yes.y, no.y), select(which, yes.z, no.z)};
}
HWY_INLINE Lanes square_root(const Lanes& a) {
  Lanes r;
  r.part[0] = hn::Sqrt(a.part[0]);
  return r;
}

/// Writes the lanes of `which` to `to` one after the other; up to `lanes` elements there may
/// change. Returns how many they are.
template <class Vectors, class T>
HWY_INLINE std::uint32_t put(const Vectors& values, const Truths<lanes>& which, T* to) {
  const typename Vectors::Tag d;
  const auto mask = hn::RebindMask(d, which.part[0]);
  hn::StoreU(hn::Compress(values.part[0], mask), d, to);
  return static_cast<std::uint32_t>(hn::CountTrue(d, mask));
}

inline constexpr std::uint32_t surface_chunk = 64;

/// The surfaces that up to `surface_chunk` rays have met.
class SurfaceChunk {
 public:
  /// Of the rays from `first` on. Lanes past `count` are no surfaces.
  void find(const Scene& scene, const Rays& rays, const Hits& hits, std::uint32_t first,
            std::uint32_t count) {
    for (std::uint32_t i = 0; i < surface_chunk; ++i) {
      triangle_[i] = i < count ? hits.triangle[first + i] : no_triangle;
      if (triangle_[i] == no_triangle) {
        set(i, {}, {}, {}, {}, {});
        continue;
      }
      const Material& material = scene.materials[scene.mesh.material[triangle_[i]]];
      set(i, scene.mesh.corner(triangle_[i], 0), scene.mesh.corner(triangle_[i], 1),
          scene.mesh.corner(triangle_[i], 2), material.diffuse, material.specular);
    }
    for (std::uint32_t i = 0; i < count; i += lanes) {
      Lanes largest(0.0f);
      for (const auto& row : corner_) largest = greater(largest, magnitude(Lanes::load(row + i)));
      largest.store(magnitude_ + i);
      for (int half = 0; half < lanes; half += wide) {
        const std::uint32_t at = i + static_cast<std::uint32_t>(half);
        find_plane(rays, hits, first + at, at);
      }
    }
  }

  [[nodiscard]] HWY_INLINE Truths<lanes> is_hit(std::uint32_t i) const {
    return Indices<lanes>::load(triangle_ + i) != Indices<lanes>(no_triangle);
  }
  /// A hit on a triangle that has a normal.
  [[nodiscard]] HWY_INLINE Truths<lanes> is_surface(std::uint32_t i) const {
    return Lanes::load(sound_ + i) > Lanes(0.0f);
  }
  [[nodiscard]] HWY_INLINE Lanes3 point(std::uint32_t i) const { return load(point_, i); }
  [[nodiscard]] HWY_INLINE Lanes3 normal(std::uint32_t i) const { return load(normal_, i); }
  [[nodiscard]] HWY_INLINE Lanes3 diffuse(std::uint32_t i) const { return load(diffuse_, i); }
  [[nodiscard]] HWY_INLINE Lanes3 specular(std::uint32_t i) const { return load(specular_, i); }

  /// Surface::lifted
  [[nodiscard]] HWY_INLINE Lanes3 lifted(std::uint32_t i, const Lanes3& other_end) const {
    const Lanes reach = greater(greater(Lanes::load(magnitude_ + i), magnitude(other_end.x)),
                                greater(magnitude(other_end.y), magnitude(other_end.z)));
    return point(i) + normal(i) * (reach * Lanes(0x1p-17f));
  }

 private:
  using Row = float[surface_chunk];
  using Wide = hn::CappedTag<double, lanes / 2>;
  static constexpr int wide = static_cast<int>(hn::MaxLanes(Wide()));
  using Narrow = hn::Rebind<float, Wide>;
  using Doubles = hn::Vec<Wide>;

  void set(std::uint32_t i, Vec3 a, Vec3 b, Vec3 c, Vec3 diffuse, Vec3 specular) {
    for (int axis = 0; axis < 3; ++axis) {
      corner_[axis][i] = a[axis];
      corner_[axis + 3][i] = b[axis];
      corner_[axis + 6][i] = c[axis];
      diffuse_[axis][i] = diffuse[axis];
      specular_[axis][i] = specular[axis];
    }
  }
  static HWY_INLINE Lanes3 load(const Row (&rows)[3], std::uint32_t i) {
    return {Lanes::load(rows[0] + i), Lanes::load(rows[1] + i), Lanes::load(rows[2] + i)};
  }

  static HWY_INLINE Doubles widen(const float* from) {
    return hn::PromoteTo(Wide(), hn::Load(Narrow(), from));
  }
  static HWY_INLINE void narrow(Doubles from, float* to) {
    hn::Store(hn::DemoteTo(Narrow(), from), Narrow(), to);
  }

  /// The part of `surface_at` that is in double precision, from ray `lane` and element `i` on.
  HWY_INLINE void find_plane(const Rays& rays, const Hits& hits, std::uint32_t lane,
                             std::uint32_t i) {
    const Wide d;
    Doubles a[3], p[3], q[3];
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = widen(corner_[axis] + i);
      p[axis] = hn::Sub(widen(corner_[axis + 3] + i), a[axis]);
      q[axis] = hn::Sub(widen(corner_[axis + 6] + i), a[axis]);
    }
    Doubles n[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      n[axis] = hn::Sub(hn::Mul(p[next], q[last]), hn::Mul(p[last], q[next]));
    }
    const auto sum = [](Doubles x, Doubles y, Doubles z)
                         HWY_ATTR { return hn::Add(hn::Add(x, y), z); };
    const Doubles size =
        hn::Sqrt(sum(hn::Mul(n[0], n[0]), hn::Mul(n[1], n[1]), hn::Mul(n[2], n[2])));
    narrow(hn::IfThenElse(hn::Gt(size, hn::Zero(d)), hn::Set(d, 1.0), hn::Zero(d)), sound_ + i);
    const Doubles towards = sum(hn::Mul(n[0], widen(&rays.direction_x[lane])),
                                hn::Mul(n[1], widen(&rays.direction_y[lane])),
                                hn::Mul(n[2], widen(&rays.direction_z[lane])));
    const Doubles to_unit = hn::Div(
        hn::IfThenElse(hn::Gt(towards, hn::Zero(d)), hn::Set(d, -1.0), hn::Set(d, 1.0)), size);
    const Doubles u = widen(&hits.u[lane]), v = widen(&hits.v[lane]);
    for (int axis = 0; axis < 3; ++axis) {
      narrow(sum(a[axis], hn::Mul(u, p[axis]), hn::Mul(v, q[axis])), point_[axis] + i);
      narrow(hn::Mul(n[axis], to_unit), normal_[axis] + i);
    }
  }

  alignas(64) std::uint32_t triangle_[surface_chunk];
  alignas(64) Row corner_[9];
  alignas(64) Row diffuse_[3], specular_[3];
  alignas(64) Row point_[3], normal_[3];
  alignas(64) Row magnitude_, sound_;
};

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
