/// N floats side by side, N a power of two from 4 to 16, on whatever vectors the target has.
///
/// One source for every width and instruction set: `Floats<16>` is one register on AVX-512, two on
/// AVX2, four on SSE4. Included once per target (Highway's foreach_target), hence no #pragma once.
/// Every operation rounds like its scalar counterpart; nothing is fused.
#if defined(IRT_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_LANES_INL
#undef IRT_LANES_INL
#else
#define IRT_LANES_INL
#endif

#include <bit>
#include <cmath>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <int N>
struct FloatLayout {
  using Tag = hn::CappedTag<float, N>;
  static constexpr int per_part = static_cast<int>(hn::MaxLanes(Tag()));
  static constexpr int parts = N / per_part;
};

/// A truth value per lane.
template <int N>
struct Truths {
  using Layout = FloatLayout<N>;
  hn::Mask<typename Layout::Tag> part[Layout::parts];

  /// Bit i is lane i.
  [[nodiscard]] HWY_INLINE std::uint32_t bits() const {
    std::uint32_t all = 0;
    for (int i = 0; i < Layout::parts; ++i) {
      alignas(8) std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(typename Layout::Tag(), part[i], bytes);
      std::uint16_t some;
      __builtin_memcpy(&some, bytes, sizeof some);
      all |= static_cast<std::uint32_t>(some) << (i * Layout::per_part);
    }
    return all;
  }
};

template <int N>
struct Floats {
  using Layout = FloatLayout<N>;
  using Tag = typename Layout::Tag;
  static constexpr int width = N;
  hn::Vec<Tag> part[Layout::parts];

  Floats() = default;
  HWY_INLINE explicit Floats(float all) {
    for (auto& p : part) p = hn::Set(Tag(), all);
  }
  /// Of N floats on an N-float boundary (at most 64 bytes).
  HWY_INLINE static Floats load(const float* from) {
    Floats result;
    for (int i = 0; i < Layout::parts; ++i) {
      result.part[i] = hn::Load(Tag(), from + i * Layout::per_part);
    }
    return result;
  }
  HWY_INLINE void store(float* to) const {
    for (int i = 0; i < Layout::parts; ++i) {
      hn::Store(part[i], Tag(), to + i * Layout::per_part);
    }
  }
};

/// N numbers of triangles.
template <int N>
struct Indices {
  using Layout = FloatLayout<N>;
  using Tag = hn::Rebind<std::uint32_t, typename Layout::Tag>;
  hn::Vec<Tag> part[Layout::parts];

  Indices() = default;
  HWY_INLINE explicit Indices(std::uint32_t all) {
    for (auto& p : part) p = hn::Set(Tag(), all);
  }
  HWY_INLINE static Indices load(const std::uint32_t* from) {
    Indices result;
    for (int i = 0; i < Layout::parts; ++i) {
      result.part[i] = hn::Load(Tag(), from + i * Layout::per_part);
    }
    return result;
  }
  HWY_INLINE void store(std::uint32_t* to) const {
    for (int i = 0; i < Layout::parts; ++i) {
      hn::Store(part[i], Tag(), to + i * Layout::per_part);
    }
  }
};

// NOLINTBEGIN(bugprone-macro-parentheses): `result` and `operand` are templates.
#define IRT_LANEWISE(result, name, operand, expression)                 \
  template <int N>                                                      \
  HWY_INLINE result<N> name(const operand<N>& a, const operand<N>& b) { \
    result<N> r;                                                        \
    for (int i = 0; i < FloatLayout<N>::parts; ++i) {                   \
      const auto x = a.part[i], y = b.part[i];                          \
      r.part[i] = expression;                                           \
    }                                                                   \
    return r;                                                           \
  }
IRT_LANEWISE(Floats, operator+, Floats, hn::Add(x, y))
IRT_LANEWISE(Floats, operator-, Floats, hn::Sub(x, y))
IRT_LANEWISE(Floats, operator*, Floats, hn::Mul(x, y))
IRT_LANEWISE(Floats, operator/, Floats, hn::Div(x, y))
IRT_LANEWISE(Floats, lesser, Floats, hn::Min(x, y))   // neither is a NaN
IRT_LANEWISE(Floats, greater, Floats, hn::Max(x, y))  // neither is a NaN
IRT_LANEWISE(Floats, flip_sign, Floats,
             hn::Xor(x, hn::And(y, hn::SignBit(typename Floats<N>::Tag()))))
IRT_LANEWISE(Truths, operator<, Floats, hn::Lt(x, y))
IRT_LANEWISE(Truths, operator<=, Floats, hn::Le(x, y))
IRT_LANEWISE(Truths, operator>, Floats, hn::Gt(x, y))
IRT_LANEWISE(Truths, operator>=, Floats, hn::Ge(x, y))
IRT_LANEWISE(Truths, operator==, Floats, hn::Eq(x, y))
IRT_LANEWISE(Truths, both, Truths, hn::And(x, y))
IRT_LANEWISE(Truths, either, Truths, hn::Or(x, y))
IRT_LANEWISE(Truths, operator<, Indices, hn::RebindMask(typename Floats<N>::Tag(), hn::Lt(x, y)))
IRT_LANEWISE(Truths, operator!=, Indices, hn::RebindMask(typename Floats<N>::Tag(), hn::Ne(x, y)))
#undef IRT_LANEWISE
// NOLINTEND(bugprone-macro-parentheses)

template <int N>
HWY_INLINE Floats<N> magnitude(const Floats<N>& a) {
  Floats<N> r;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) r.part[i] = hn::Abs(a.part[i]);
  return r;
}
template <int N>
HWY_INLINE Floats<N> select(const Truths<N>& which, const Floats<N>& yes, const Floats<N>& no) {
  Floats<N> r;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    r.part[i] = hn::IfThenElse(which.part[i], yes.part[i], no.part[i]);
  }
  return r;
}
template <int N>
HWY_INLINE Indices<N> select(const Truths<N>& which, const Indices<N>& yes, const Indices<N>& no) {
  Indices<N> r;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    const auto mask = hn::RebindMask(typename Indices<N>::Tag(), which.part[i]);
    r.part[i] = hn::IfThenElse(mask, yes.part[i], no.part[i]);
  }
  return r;
}
/// The truth whose bits are `bits`.
template <int N>
HWY_INLINE Truths<N> truths(std::uint32_t bits) {
  Truths<N> r;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    alignas(8) std::uint8_t bytes[8] = {};
    const auto some = static_cast<std::uint16_t>(bits >> (i * FloatLayout<N>::per_part));
    __builtin_memcpy(bytes, &some, sizeof some);
    r.part[i] = hn::LoadMaskBits(typename Floats<N>::Tag(), bytes);
  }
  return r;
}
/// A byte per lane: 1 where it is true, else 0.
template <int N>
HWY_INLINE void store_bytes(const Truths<N>& which, std::uint8_t* to) {
  using Tag = typename Indices<N>::Tag;
  const hn::Rebind<std::uint8_t, Tag> bytes;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    const auto ones = hn::IfThenElseZero(hn::RebindMask(Tag(), which.part[i]), hn::Set(Tag(), 1));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(hn::RebindToSigned<Tag>(), ones)), bytes,
               to + i * FloatLayout<N>::per_part);
  }
}
/// True where the byte is not 0.
template <int N>
HWY_INLINE Truths<N> load_bytes(const std::uint8_t* from) {
  using Tag = typename Indices<N>::Tag;
  const hn::Rebind<std::uint8_t, Tag> bytes;
  Truths<N> r;
  for (int i = 0; i < FloatLayout<N>::parts; ++i) {
    const auto wide = hn::PromoteTo(Tag(), hn::LoadU(bytes, from + i * FloatLayout<N>::per_part));
    r.part[i] = hn::RebindMask(typename Floats<N>::Tag(), hn::Ne(wide, hn::Zero(Tag())));
  }
  return r;
}
template <int N>
HWY_INLINE float least_of(const Floats<N>& a) {
  auto least = a.part[0];
  for (int i = 1; i < FloatLayout<N>::parts; ++i) least = hn::Min(least, a.part[i]);
  return hn::GetLane(hn::MinOfLanes(typename Floats<N>::Tag(), least));
}
template <int N>
HWY_INLINE float most_of(const Floats<N>& a) {
  auto most = a.part[0];
  for (int i = 1; i < FloatLayout<N>::parts; ++i) most = hn::Max(most, a.part[i]);
  return hn::GetLane(hn::MaxOfLanes(typename Floats<N>::Tag(), most));
}
template <int N>
HWY_INLINE bool any(const Truths<N>& a) {
  auto all = a.part[0];
  for (int i = 1; i < FloatLayout<N>::parts; ++i) all = hn::Or(all, a.part[i]);
  return !hn::AllFalse(typename Floats<N>::Tag(), all);
}

// The same vocabulary for one float, so that a kernel is written once.
HWY_INLINE float flip_sign(float a, float sign) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(a) ^
                              (std::bit_cast<std::uint32_t>(sign) & 0x80000000u));
}
HWY_INLINE float magnitude(float a) {
  return std::fabs(a);
}
HWY_INLINE bool both(bool a, bool b) {
  return a && b;
}
HWY_INLINE bool either(bool a, bool b) {
  return a || b;
}
HWY_INLINE bool any(bool a) {
  return a;
}
HWY_INLINE float select(bool which, float yes, float no) {
  return which ? yes : no;
}

/// The truth type of comparisons of `F`.
template <class F>
using TruthOf = decltype(F{} < F{});

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
