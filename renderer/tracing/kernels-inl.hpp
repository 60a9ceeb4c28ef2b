/// Ray against triangle, written once: for one float, for a packet of rays against one triangle,
/// and for one ray against several triangles. Included once per target.
///
/// A kernel has what it knows of a triangle and of a ray beforehand (`prepare`), what the ray's
/// origin adds to the triangle (`see`; rays that share an origin share it), and the test itself
/// (`cross_at`). Operations and their order are the same for every type, nothing is fused, so every
/// width and instruction set gives the same bits. Different kernels differ by rounding.
///
/// Whatever a kernel prepares consists of values of one type `F` only, and its `from` makes it of a
/// function that gives them in their order: so it can be moved between types.
///
/// Points, needles and NaNs are met by none.
#if defined(IRT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_KERNELS_INL
#undef IRT_KERNELS_INL
#else
#define IRT_KERNELS_INL
#endif

#include "renderer/scene/vec3.hpp"
#include "renderer/tracing/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

template <class F>
struct VecOf {
  F x, y, z;

  template <class Next>
  HWY_INLINE static VecOf from(Next& next) {
    return {next(), next(), next()};
  }
};
template <class F>
HWY_INLINE VecOf<F> operator-(const VecOf<F>& a, const VecOf<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
HWY_INLINE F dot(const VecOf<F>& a, const VecOf<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
HWY_INLINE VecOf<F> cross(const VecOf<F>& a, const VecOf<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class F>
HWY_INLINE VecOf<F> broadcast(const Vec3& a) {
  return {F(a.x), F(a.y), F(a.z)};
}

template <class F>
struct CornersOf {
  using Value = F;
  VecOf<F> a, b, c;

  template <class Next>
  HWY_INLINE static CornersOf from(Next& next) {
    return {VecOf<F>::from(next), VecOf<F>::from(next), VecOf<F>::from(next)};
  }
};

template <class F>
struct LineOf {
  using Value = F;
  VecOf<F> origin, direction;
  F end;  ///< how far it goes

  template <class Next>
  HWY_INLINE static LineOf from(Next& next) {
    return {VecOf<F>::from(next), VecOf<F>::from(next), next()};
  }
};

/// Where lines cross triangles; `t`, `u`, `v` are undefined where `met` is false.
template <class F>
struct CrossingOf {
  TruthOf<F> met;
  F t, u, v;  ///< as in `Hits`
};

/// Whether `a`, not negative, is a normal number, so that 1 / a is finite.
template <class F>
HWY_INLINE TruthOf<F> is_invertible(const F& a) {
  return both(a >= F(std::numeric_limits<float>::min()), a <= F(std::numeric_limits<float>::max()));
}

/// The crossing whose coordinates are `t`, `u` and `v` times `size`. None lies beyond `end`: most
/// triangles that a shadow ray passes behind its end are told apart by a multiplication.
template <class F>
HWY_INLINE CrossingOf<F> crossing_of(const F& u, const F& v, const F& t, const F& size,
                                     const F& end) {
  const F zero(0.0f);
  CrossingOf<F> crossing{};
  crossing.met = both(both(both(u >= zero, v >= zero), u + v <= size),
                      both(is_invertible(size), t <= end * size));
  if (!any(crossing.met)) return crossing;
  const F inverse = F(1.0f) / size;
  crossing.t = t * inverse;
  crossing.u = u * inverse;
  crossing.v = v * inverse;
  return crossing;
}

/// The whole test of `Kernel` on a triangle and a line that it has prepared.
template <class Kernel, class F>
HWY_INLINE CrossingOf<F> cross_at(const typename Kernel::template Triangle<F>& triangle,
                                  const typename Kernel::template Line<F>& line) {
  return Kernel::cross_at(Kernel::see(triangle, line.origin), line);
}

/// What a kernel has prepared for N things, ready to be taken out one by one.
template <class From, int N>
class ByLane {
 public:
  explicit HWY_INLINE ByLane(const From& of) {
    static_assert(sizeof values_ == sizeof of);
    __builtin_memcpy(values_, &of, sizeof of);
  }

  /// The thing in `lane` in every lane of a `To`, which is the same for other values.
  template <class To>
  [[nodiscard]] HWY_INLINE To one(int lane) const {
    int field = 0;
    const auto next = [&]() HWY_ATTR { return typename To::Value(values_[field++][lane]); };
    return To::from(next);
  }

 private:
  alignas(64) float values_[sizeof(From) / sizeof(Floats<N>)][N];
};

/// A corner, the edges from there, and what these span.
template <class F>
struct SpannedTriangle {
  using Value = F;
  VecOf<F> a, edge1, edge2, normal;

  template <class Next>
  HWY_INLINE static SpannedTriangle from(Next& next) {
    return {VecOf<F>::from(next), VecOf<F>::from(next), VecOf<F>::from(next), VecOf<F>::from(next)};
  }
};

/// Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection", with the triple
/// products turned so that the direction comes last: what it is multiplied with depends on the
/// triangle and the origin alone. No division happens before the sides are known, and the
/// determinant meets no threshold but the range in which it has an inverse: it shrinks with the
/// square of the edges, so no other threshold suits all meshes.
struct MollerTrumbore {
  template <class F>
  using Triangle = SpannedTriangle<F>;
  template <class F>
  struct Seen {
    using Value = F;
    VecOf<F> normal, side_u, side_v;
    F height;

    template <class Next>
    HWY_INLINE static Seen from(Next& next) {
      return {VecOf<F>::from(next), VecOf<F>::from(next), VecOf<F>::from(next), next()};
    }
  };
  template <class F>
  using Line = LineOf<F>;

  template <class F>
  HWY_INLINE static Triangle<F> prepare(const CornersOf<F>& corners) {
    const VecOf<F> edge1 = corners.b - corners.a, edge2 = corners.c - corners.a;
    return {corners.a, edge1, edge2, cross(edge2, edge1)};
  }
  template <class F>
  HWY_INLINE static const Line<F>& prepare(const LineOf<F>& line) {
    return line;
  }
  template <class F>
  HWY_INLINE static Seen<F> see(const Triangle<F>& triangle, const VecOf<F>& origin) {
    const VecOf<F> s = origin - triangle.a;
    const VecOf<F> q = cross(s, triangle.edge1);
    return {triangle.normal, cross(triangle.edge2, s), q, dot(triangle.edge2, q)};
  }
  template <class F>
  HWY_INLINE static CrossingOf<F> cross_at(const Seen<F>& seen, const Line<F>& line) {
    const F determinant = dot(line.direction, seen.normal);
    const F u = flip_sign(dot(line.direction, seen.side_u), determinant);
    const F v = flip_sign(dot(line.direction, seen.side_v), determinant);
    const F height = flip_sign(seen.height, determinant);
    return crossing_of(u, v, height, magnitude(determinant), line.end);
  }
};

/// Kensler and Shirley 2006, "Optimizing ray-triangle intersection via automated search": the same
/// volumes with the normal computed beforehand, which saves a cross product per test.
struct KenslerShirley {
  template <class F>
  using Triangle = SpannedTriangle<F>;
  template <class F>
  struct Seen {
    using Value = F;
    VecOf<F> edge1, edge2, normal, to;
    F height;

    template <class Next>
    HWY_INLINE static Seen from(Next& next) {
      return {VecOf<F>::from(next), VecOf<F>::from(next), VecOf<F>::from(next),
              VecOf<F>::from(next), next()};
    }
  };
  template <class F>
  using Line = LineOf<F>;

  template <class F>
  HWY_INLINE static Triangle<F> prepare(const CornersOf<F>& corners) {
    const VecOf<F> edge1 = corners.b - corners.a, edge2 = corners.c - corners.a;
    return {corners.a, edge1, edge2, cross(edge1, edge2)};
  }
  template <class F>
  HWY_INLINE static const Line<F>& prepare(const LineOf<F>& line) {
    return line;
  }
  template <class F>
  HWY_INLINE static Seen<F> see(const Triangle<F>& triangle, const VecOf<F>& origin) {
    const VecOf<F> to = triangle.a - origin;
    return {triangle.edge1, triangle.edge2, triangle.normal, to, dot(triangle.normal, to)};
  }
  template <class F>
  HWY_INLINE static CrossingOf<F> cross_at(const Seen<F>& seen, const Line<F>& line) {
    const VecOf<F> r = cross(seen.to, line.direction);
    const F determinant = dot(seen.normal, line.direction);
    const F zero(0.0f);
    const F u = flip_sign(dot(r, seen.edge2), determinant);
    const F v = flip_sign(zero - dot(r, seen.edge1), determinant);
    const F height = flip_sign(seen.height, determinant);
    return crossing_of(u, v, height, magnitude(determinant), line.end);
  }
};

/// The thesis' test (Wald 2004, section 7.1; after Bikker): project along the axis that the normal
/// is closest to and weigh the corners in that plane. Everything of the triangle is computed
/// beforehand, 11 numbers of it. The plane's offset cancels far from the world's origin: of the
/// four this kernel is the least precise there.
struct Projection {
  template <class F>
  struct Triangle {
    using Value = F;
    F axis;  ///< 0, 1 or 2
    F normal_u, normal_v, offset;
    F a_u, a_v, b_u, b_v, c_u, c_v;

    template <class Next>
    HWY_INLINE static Triangle from(Next& next) {
      return {next(), next(), next(), next(), next(), next(), next(), next(), next(), next()};
    }
  };
  template <class F>
  struct Seen {
    using Value = F;
    Triangle<F> triangle;
    F height, from_u, from_v;  ///< of the origin, the height over the triangle's plane

    template <class Next>
    HWY_INLINE static Seen from(Next& next) {
      return {Triangle<F>::from(next), next(), next(), next()};
    }
  };
  template <class F>
  using Line = LineOf<F>;

  template <class F>
  HWY_INLINE static Triangle<F> prepare(const CornersOf<F>& corners) {
    const VecOf<F> edge1 = corners.b - corners.a, edge2 = corners.c - corners.a;
    const VecOf<F> normal = cross(edge1, edge2);
    const F x = magnitude(normal.x), y = magnitude(normal.y), z = magnitude(normal.z);
    Triangle<F> triangle;
    triangle.axis = select(both(x >= y, x >= z), F(0.0f), select(y >= z, F(1.0f), F(2.0f)));
    const Turned<F> n(normal, triangle.axis), a(corners.a, triangle.axis);
    const Turned<F> e1(edge1, triangle.axis), e2(edge2, triangle.axis);
    const F inverse = F(1.0f) / n.w, zero(0.0f);
    triangle.normal_u = n.u * inverse;
    triangle.normal_v = n.v * inverse;
    triangle.offset = a.w + triangle.normal_u * a.u + triangle.normal_v * a.v;
    triangle.a_u = a.u;
    triangle.a_v = a.v;
    triangle.b_u = e2.v * inverse;
    triangle.b_v = zero - e2.u * inverse;
    triangle.c_u = zero - e1.v * inverse;
    triangle.c_v = e1.u * inverse;
    return triangle;
  }
  template <class F>
  HWY_INLINE static const Line<F>& prepare(const LineOf<F>& line) {
    return line;
  }
  template <class F>
  HWY_INLINE static Seen<F> see(const Triangle<F>& triangle, const VecOf<F>& origin) {
    const Turned<F> o(origin, triangle.axis);
    return {triangle, triangle.offset - o.w - triangle.normal_u * o.u - triangle.normal_v * o.v,
            o.u, o.v};
  }
  template <class F>
  HWY_INLINE static CrossingOf<F> cross_at(const Seen<F>& seen, const Line<F>& line) {
    const Triangle<F>& triangle = seen.triangle;
    const Turned<F> d(line.direction, triangle.axis);
    const F speed = d.w + triangle.normal_u * d.u + triangle.normal_v * d.v;
    CrossingOf<F> crossing{};
    crossing.t = seen.height / speed;
    const F at_u = seen.from_u + crossing.t * d.u - triangle.a_u;
    const F at_v = seen.from_v + crossing.t * d.v - triangle.a_v;
    crossing.u = at_u * triangle.b_u + at_v * triangle.b_v;
    crossing.v = at_u * triangle.c_u + at_v * triangle.c_v;
    const F zero(0.0f);
    // A needle's normal or a line along the plane makes infinities and NaNs, which fail here.
    crossing.met =
        both(both(crossing.u >= zero, crossing.v >= zero), crossing.u + crossing.v <= F(1.0f));
    return crossing;
  }

 private:
  /// A vector's components with `axis` last, in cyclic order.
  template <class F>
  struct Turned {
    F u, v, w;
    HWY_INLINE Turned(const VecOf<F>& a, const F& axis) {
      const TruthOf<F> is_x = axis<F(0.5f), is_z = axis> F(1.5f);
      u = select(is_x, a.y, select(is_z, a.x, a.z));
      v = select(is_x, a.z, select(is_z, a.y, a.x));
      w = select(is_x, a.x, select(is_z, a.z, a.y));
    }
  };
};

/// Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection": corners are sheared into
/// the ray's frame, where an edge that two triangles share has the same coordinates in both, and
/// the sign of its side is exact (products in double precision where single ones cancel). A ray
/// through a shared edge or vertex of a closed mesh meets one of the triangles.
struct Watertight {
  template <class F>
  using Triangle = CornersOf<F>;
  template <class F>
  struct Seen {
    using Value = F;
    CornersOf<F> corners;  ///< from the origin

    template <class Next>
    HWY_INLINE static Seen from(Next& next) {
      return {CornersOf<F>::from(next)};
    }
  };
  template <class F>
  struct Line {
    using Value = F;
    VecOf<F> origin;
    F axis;  ///< the largest component of the direction: 0, 1 or 2
    F shear_u, shear_v, scale;

    template <class Next>
    HWY_INLINE static Line from(Next& next) {
      return {VecOf<F>::from(next), next(), next(), next(), next()};
    }
  };

  template <class F>
  HWY_INLINE static const Triangle<F>& prepare(const CornersOf<F>& corners) {
    return corners;
  }
  template <class F>
  HWY_INLINE static Line<F> prepare(const LineOf<F>& line) {
    const F x = magnitude(line.direction.x), y = magnitude(line.direction.y),
            z = magnitude(line.direction.z);
    Line<F> prepared;
    prepared.origin = line.origin;
    prepared.axis = select(both(x >= y, x >= z), F(0.0f), select(y >= z, F(1.0f), F(2.0f)));
    const VecOf<F> d = turn(line.direction, prepared.axis);
    prepared.scale = F(1.0f) / d.z;
    prepared.shear_u = d.x / d.z;
    prepared.shear_v = d.y / d.z;
    return prepared;
  }
  template <class F>
  HWY_INLINE static Seen<F> see(const Triangle<F>& triangle, const VecOf<F>& origin) {
    return {{triangle.a - origin, triangle.b - origin, triangle.c - origin}};
  }
  template <class F>
  HWY_INLINE static CrossingOf<F> cross_at(const Seen<F>& seen, const Line<F>& line) {
    const VecOf<F> a = shear(seen.corners.a, line), b = shear(seen.corners.b, line),
                   c = shear(seen.corners.c, line);
    const F of_a = difference_of_products(c.x, b.y, c.y, b.x);
    const F of_b = difference_of_products(a.x, c.y, a.y, c.x);
    const F of_c = difference_of_products(b.x, a.y, b.y, a.x);
    const F zero(0.0f);
    const TruthOf<F> all_left = both(both(of_a >= zero, of_b >= zero), of_c >= zero);
    const TruthOf<F> all_right = both(both(of_a <= zero, of_b <= zero), of_c <= zero);
    const F determinant = of_a + of_b + of_c;
    CrossingOf<F> crossing{};
    crossing.met = both(either(all_left, all_right), is_invertible(magnitude(determinant)));
    if (!any(crossing.met)) return crossing;
    const F inverse = F(1.0f) / determinant;
    crossing.t =
        (of_a * (line.scale * a.z) + of_b * (line.scale * b.z) + of_c * (line.scale * c.z)) *
        inverse;
    crossing.u = of_b * inverse;
    crossing.v = of_c * inverse;
    return crossing;
  }

 private:
  template <class F>
  HWY_INLINE static VecOf<F> turn(const VecOf<F>& a, const F& axis) {
    const TruthOf<F> is_x = axis<F(0.5f), is_z = axis> F(1.5f);
    return {select(is_x, a.y, select(is_z, a.x, a.z)), select(is_x, a.z, select(is_z, a.y, a.x)),
            select(is_x, a.x, select(is_z, a.z, a.y))};
  }
  /// `corner` with the ray along the third axis.
  template <class F>
  HWY_INLINE static VecOf<F> shear(const VecOf<F>& corner, const Line<F>& line) {
    const VecOf<F> from = turn(corner, line.axis);
    return {from.x - line.shear_u * from.z, from.y - line.shear_v * from.z, from.z};
  }
  /// a * b - c * d with the right sign: rounding is monotone, so only a difference of zero can
  /// hide one, and in double precision the products are exact.
  HWY_INLINE static float difference_of_products(float a, float b, float c, float d) {
    const float difference = a * b - c * d;
    if (difference != 0) return difference;
    return static_cast<float>(static_cast<double>(a) * static_cast<double>(b) -
                              static_cast<double>(c) * static_cast<double>(d));
  }
  template <int N>
  HWY_INLINE static Floats<N> difference_of_products(const Floats<N>& a, const Floats<N>& b,
                                                     const Floats<N>& c, const Floats<N>& d) {
    const Floats<N> difference = a * b - c * d;
    std::uint32_t zeros = (difference == Floats<N>(0.0f)).bits();
    if (zeros == 0) return difference;
    alignas(64) float as[N], bs[N], cs[N], ds[N], results[N];
    a.store(as);
    b.store(bs);
    c.store(cs);
    d.store(ds);
    difference.store(results);
    for (; zeros != 0; zeros &= zeros - 1) {
      const int i = std::countr_zero(zeros);
      results[i] = difference_of_products(as[i], bs[i], cs[i], ds[i]);
    }
    return Floats<N>::load(results);
  }
};

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
