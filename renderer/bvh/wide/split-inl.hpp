/// Where to split a set of triangles: binning by centre and the sweep over the bins. Included once
/// per instruction set.
#if defined(IRT_WIDE_SPLIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_SPLIT_INL
#undef IRT_WIDE_SPLIT_INL
#else
#define IRT_WIDE_SPLIT_INL
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>
#include <memory>
#include <new>

#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/tracing/intersection.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Four = hn::CappedTag<float, 4>;
static_assert(hn::MaxLanes(Four()) == 4, "boxes are handled as four floats");
using FourFloats = hn::Vec<Four>;
using FourInts = hn::RebindToSigned<Four>;

/// Lower and negated upper corner, so that one minimum grows both. The fourth and the eighth lane
/// are free.
struct alignas(32) SignedBox {
  using Eight = hn::CappedTag<float, 8>;
  static constexpr float infinity = std::numeric_limits<float>::infinity();

  float of[8];

  static SignedBox empty() {
    SignedBox box;
    std::fill_n(box.of, 8, infinity);
    return box;
  }
  HWY_INLINE void add(const SignedBox& other) {
    const Eight d;
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
      hn::Store(hn::Min(hn::Load(d, of + i), hn::Load(d, other.of + i)), d, of + i);
    }
  }
  [[nodiscard]] Box box() const { return {{of[0], of[1], of[2]}, {-of[4], -of[5], -of[6]}}; }
};

/// A triangle as the builder sees it: its box, and its number in the free lane.
struct Reference : SignedBox {
  HWY_INLINE Reference(FourFloats lower, FourFloats negated_upper, std::uint32_t triangle) {
    const Four d;
    hn::Store(lower, d, of);
    hn::Store(negated_upper, d, of + 4);
    of[3] = std::bit_cast<float>(triangle | of_normal_float);
    of[7] = 0;
  }
  [[nodiscard]] std::uint32_t triangle() const {
    return std::bit_cast<std::uint32_t>(of[3]) & ~of_normal_float;
  }

  /// Twice the centre, which costs less than the centre and is as good to split by.
  [[nodiscard]] HWY_INLINE FourFloats center() const {
    return hn::Sub(hn::Load(Four(), of), hn::Load(Four(), of + 4));
  }

 private:
  /// The free lanes take part in all arithmetic. A small number's bits are those of a denormal
  /// float, which slows that down by an order of magnitude. WideChild has no bits for as many
  /// triangles.
  static constexpr std::uint32_t of_normal_float = 1u << 30;
};

/// The box around centres, as Reference::center has them.
struct CenterBounds {
  SignedBox box = SignedBox::empty();

  void add(const CenterBounds& other) { box.add(other.box); }
  HWY_INLINE void set(FourFloats lower, FourFloats upper) {
    const Four d;
    hn::Store(lower, d, box.of);
    hn::Store(hn::Neg(upper), d, box.of + 4);
  }
};

/// A stretch of references in one of two buffers, and the boxes around them and their centres.
struct Range {
  std::uint32_t begin, end;
  std::uint32_t buffer;
  int depth;
  float area;
  Box box;
  CenterBounds centers;

  [[nodiscard]] std::uint32_t count() const { return end - begin; }
};

/// Half of a box's surface, in a unit of length in which nothing overflows.
struct Measure {
  float unit = 1;

  [[nodiscard]] float half_area(const Box& box) const {
    const Vec3 d = box.hi * unit - box.lo * unit;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

/// The references twice: a split moves those of a range from one buffer to the other.
class Buffers {
 public:
  explicit Buffers(std::uint32_t count) : data_{allocate(count), allocate(count)} {}

  [[nodiscard]] Reference* of(const Range& range) const {
    return data_[range.buffer].get() + range.begin;
  }
  [[nodiscard]] Reference* other(const Range& range) const {
    return data_[1 - range.buffer].get() + range.begin;
  }

 private:
  struct Release {
    void operator()(Reference* data) const { ::operator delete (data, std::align_val_t{64}); }
  };
  using Data = std::unique_ptr<Reference[], Release>;

  static Data allocate(std::uint32_t count) {
    return Data(
        static_cast<Reference*>(::operator new (count * sizeof(Reference), std::align_val_t{64})));
  }

  Data data_[2];
};

inline float blocks_of(std::uint32_t count) {
  const std::uint32_t blocks = (count + wide_block - 1) / wide_block;
  return static_cast<float>(blocks);
}

inline Box bounds(const Reference* references, std::uint32_t count) {
  SignedBox all = SignedBox::empty();
  for (std::uint32_t i = 0; i < count; ++i) all.add(references[i]);
  return all.box();
}

inline CenterBounds center_bounds(const Reference* references, std::uint32_t count) {
  const Four d;
  FourFloats lower = hn::Set(d, SignedBox::infinity);
  FourFloats upper = hn::Set(d, -SignedBox::infinity);
  for (std::uint32_t i = 0; i < count; ++i) {
    const FourFloats center = references[i].center();
    lower = hn::Min(lower, center);
    upper = hn::Max(upper, center);
  }
  CenterBounds result;
  result.set(lower, upper);
  return result;
}

/// Maps a centre to a bin per axis. An axis without extent has a scale of 0.
struct Binning {
  static constexpr int most = 32;
  alignas(16) float base[4] = {};
  alignas(16) float scale[4] = {};
  int bins = 0;

  Binning() = default;
  Binning(const CenterBounds& centers, std::uint32_t count)
      : bins(static_cast<int>(std::min<std::uint32_t>(most, 4 + count / 20))) {
    const Box box = centers.box.box();
    for (int axis = 0; axis < 3; ++axis) {
      base[axis] = box.lo[axis];
      const float extent = box.hi[axis] - box.lo[axis];
      const float per_length = static_cast<float>(bins) * 0.999f / extent;
      if (extent > 0 && per_length <= std::numeric_limits<float>::max()) scale[axis] = per_length;
    }
  }

  /// Where the bin with that number along an axis is in an array of the bins of all axes. Every
  /// fourth place there is free.
  static constexpr int place(int bin, int axis) { return 4 * bin + axis; }
};

/// A binning at hand in registers.
class Binner {
 public:
  explicit Binner(const Binning& binning)
      : base_(hn::Load(Four(), binning.base)), scale_(hn::Load(Four(), binning.scale)) {}

  /// The places of a centre's bins along x, y and z in the first three lanes. Centres within the
  /// bounds of the binning have their bins; whatever else there may be, garbage included, has
  /// places of the right axis, and always the same.
  HWY_INLINE hn::Vec<FourInts> operator()(FourFloats center) const {
    const FourFloats bin = hn::Floor(hn::Mul(hn::Sub(center, base_), scale_));
    // Floats from here on are quarters apart: their last bits count quarters.
    const FourFloats shifted = hn::Add(bin, hn::Set(Four(), 0x1p21f));
    const FourInts d;
    const auto last_bits = hn::Set(d, Binning::place(Binning::most - 1, 0));
    return hn::Add(hn::And(hn::BitCast(d, shifted), last_bits), hn::Iota(d, 0));
  }

 private:
  FourFloats base_, scale_;
};

/// Left are the triangles in bins below `plane` along `axis`.
struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;
  int plane = 0;
  Binning binning;
  std::uint32_t left_count = 0;
  float left_area = 0, right_area = 0;
  Box left_box, right_box;

  [[nodiscard]] bool found() const { return axis >= 0; }
};

/// Triangles per bin and axis with the boxes around them.
struct Bins {
  SignedBox box[Binning::most * 4];
  alignas(16) std::int32_t count[Binning::most * 4];

  /// Empties as many bins as are used; the others are left as they are.
  void clear(int bins) {
    for (int bin = 0; bin < bins; ++bin) {
      std::fill_n(box + Binning::place(bin, 0), 3, SignedBox::empty());
      std::fill_n(count + Binning::place(bin, 0), 4, 0);
    }
  }

  void fill(const Reference* references, std::uint32_t number, const Binning& binning) {
    clear(binning.bins);
    const Binner binner(binning);
    // Neighbours fall into the same bins, and each waits for what the last one has stored there:
    // two sets of bins in turn wait half as long.
    constexpr std::uint32_t worth_two_sets = 256;
    if (number < worth_two_sets) {
      for (std::uint32_t i = 0; i < number; ++i) put(references[i], binner);
      return;
    }
    Bins odd;
    odd.clear(binning.bins);
    for (std::uint32_t i = 0; i + 1 < number; i += 2) {
      put(references[i], binner);
      odd.put(references[i + 1], binner);
    }
    if (number % 2 != 0) put(references[number - 1], binner);
    add(odd, binning.bins);
  }

  void add(const Bins& other, int bins) {
    for (int bin = 0; bin < bins; ++bin) {
      for (int axis = 0; axis < 3; ++axis) {
        const int place = Binning::place(bin, axis);
        box[place].add(other.box[place]);
        count[place] += other.count[place];
      }
    }
  }

  /// The references left of `split`.
  [[nodiscard]] std::uint32_t left_of(const Split& split) const {
    std::int32_t left = 0;
    for (int bin = 0; bin < split.plane; ++bin) left += count[Binning::place(bin, split.axis)];
    return static_cast<std::uint32_t>(left);
  }

  /// The plane of least cost: surface times number of blocks on either side.
  [[nodiscard]] Split best(const Binning& binning, const Measure& measure) const {
    Split split;
    split.binning = binning;
    sweep(split, measure);
    if (!split.found()) return split;
    split.left_count = left_of(split);
    split.left_box = box_of(0, split.plane, split.axis);
    split.right_box = box_of(split.plane, binning.bins, split.axis);
    split.left_area = measure.half_area(split.left_box);
    split.right_area = measure.half_area(split.right_box);
    return split;
  }

 private:
  HWY_INLINE void put(const Reference& reference, const Binner& binner) {
    alignas(16) std::int32_t place[4];
    hn::Store(binner(reference.center()), FourInts(), place);
    put(reference, static_cast<std::uint32_t>(place[0]));
    put(reference, static_cast<std::uint32_t>(place[1]));
    put(reference, static_cast<std::uint32_t>(place[2]));
  }
  HWY_INLINE void put(const Reference& reference, std::uint32_t place) {
    box[place].add(reference);
    ++count[place];
  }

  [[nodiscard]] Box box_of(int first_bin, int end, int axis) const {
    SignedBox all = SignedBox::empty();
    for (int bin = first_bin; bin < end; ++bin) all.add(box[Binning::place(bin, axis)]);
    return all.box();
  }

  /// The boxes along the three axes and their counts, which grow bin by bin.
  class Growing {
   public:
    HWY_INLINE Growing() : count(hn::Zero(FourInts())) {
      for (int axis = 0; axis < 3; ++axis) {
        lower_[axis] = upper_[axis] = hn::Set(Four(), SignedBox::infinity);
      }
    }
    HWY_INLINE void add(const Bins& bins, int bin) {
      for (int axis = 0; axis < 3; ++axis) {
        const float* const sides = bins.box[Binning::place(bin, axis)].of;
        lower_[axis] = hn::Min(lower_[axis], hn::Load(Four(), sides));
        upper_[axis] = hn::Min(upper_[axis], hn::Load(Four(), sides + 4));
      }
      count = hn::Add(count, hn::Load(FourInts(), bins.count + Binning::place(bin, 0)));
    }
    /// Half of the surface times the number of blocks.
    [[nodiscard]] HWY_INLINE FourFloats cost(FourFloats unit) const {
      const FourFloats a = extent(0, unit), b = extent(1, unit), c = extent(2, unit);
      // From the extents of each box to those of all boxes along x, y and z.
      const Four d;
      const FourFloats lower = hn::InterleaveLower(d, a, b), upper = hn::InterleaveUpper(d, a, b);
      const FourFloats x = hn::ConcatLowerLower(d, c, lower);
      const FourFloats y = hn::ConcatUpperUpper(d, hn::InterleaveLower(d, c, c), lower);
      const FourFloats z = hn::ConcatLowerLower(d, hn::InterleaveUpper(d, c, c), upper);
      const FourFloats area = hn::Add(hn::Add(hn::Mul(x, y), hn::Mul(y, z)), hn::Mul(z, x));
      const auto blocks =
          hn::ShiftRight<blocks_shift>(hn::Add(count, hn::Set(FourInts(), wide_block - 1)));
      return hn::Mul(area, hn::ConvertTo(d, blocks));
    }

    hn::Vec<FourInts> count;

   private:
    /// Negative, which a product of two of them does not show.
    [[nodiscard]] HWY_INLINE FourFloats extent(int axis, FourFloats unit) const {
      return hn::Add(hn::Mul(upper_[axis], unit), hn::Mul(lower_[axis], unit));
    }

    FourFloats lower_[3], upper_[3];  ///< the upper corner is negated
  };
  static constexpr int blocks_shift = std::countr_zero(unsigned{wide_block});

  /// Finds the axis and the plane of least cost, the first of several.
  void sweep(Split& split, const Measure& measure) const {
    const Four d;
    const FourInts di;
    const int bins = split.binning.bins;
    const FourFloats unit = hn::Set(d, measure.unit);
    alignas(16) float right_cost[Binning::most][4];
    alignas(16) std::int32_t right_count[Binning::most][4];
    Growing right;
    for (int plane = bins - 1; plane > 0; --plane) {
      right.add(*this, plane);
      hn::Store(right.cost(unit), d, right_cost[plane]);
      hn::Store(right.count, di, right_count[plane]);
    }
    const auto none = hn::Zero(di);
    const auto in_use = hn::Gt(hn::Load(d, split.binning.scale), hn::Zero(d));
    FourFloats least = hn::Set(d, std::numeric_limits<float>::infinity());
    auto where = none;
    Growing left;
    for (int plane = 1; plane < bins; ++plane) {
      left.add(*this, plane - 1);
      const FourFloats cost = hn::Add(left.cost(unit), hn::Load(d, right_cost[plane]));
      const auto both = hn::Gt(hn::Min(left.count, hn::Load(di, right_count[plane])), none);
      const auto better = hn::And(hn::And(hn::Lt(cost, least), hn::RebindMask(d, both)), in_use);
      least = hn::IfThenElse(better, cost, least);
      where = hn::IfThenElse(hn::RebindMask(di, better), hn::Set(di, plane), where);
    }
    alignas(16) float costs[4];
    alignas(16) std::int32_t planes[4];
    hn::Store(least, d, costs);
    hn::Store(where, di, planes);
    for (int axis = 0; axis < 3; ++axis) {
      if (!(costs[axis] < split.cost)) continue;
      split.cost = costs[axis];
      split.axis = axis;
      split.plane = planes[axis];
    }
  }
};

inline Split find_split(const Reference* references, std::uint32_t count,
                        const CenterBounds& centers, const Measure& measure) {
  const Binning binning(centers, count);
  Bins bins;
  bins.fill(references, count, binning);
  return bins.best(binning, measure);
}

/// Copies the references to `left` and `right` by their side, in their order; returns the bounds of
/// both sides' centres.
inline std::array<CenterBounds, 2> partition(const Reference* references, std::uint32_t count,
                                             const Split& split, Reference* left,
                                             Reference* right) {
  constexpr float infinity = SignedBox::infinity;
  // What is added to a centre for the bounds of the side that it is not on. The side is as good as
  // random, so that no branch may hang on it.
  static constexpr float away[2][2] = {{0, infinity}, {infinity, 0}};
  const Four d;
  const Binner binner(split.binning);
  FourFloats lower[2] = {hn::Set(d, infinity), hn::Set(d, infinity)};
  FourFloats upper[2] = {hn::Set(d, -infinity), hn::Set(d, -infinity)};
  const int first_right = Binning::place(split.plane, split.axis);
  Reference* to[2] = {left, right};
  for (std::uint32_t i = 0; i < count; ++i) {
    const FourFloats center = references[i].center();
    alignas(16) std::int32_t place[4];
    hn::Store(binner(center), FourInts(), place);
    const bool side = place[split.axis] >= first_right;
    *to[side]++ = references[i];
    for (int k = 0; k < 2; ++k) {
      const FourFloats far = hn::Set(d, away[side][k]);
      lower[k] = hn::Min(lower[k], hn::Add(center, far));
      upper[k] = hn::Max(upper[k], hn::Sub(center, far));
    }
  }
  std::array<CenterBounds, 2> centers;
  for (int k = 0; k < 2; ++k) centers[static_cast<std::size_t>(k)].set(lower[k], upper[k]);
  return centers;
}

/// The halves of a range whose references `split` has moved to the other buffer.
inline void part_by(const Split& split, const std::array<CenterBounds, 2>& centers,
                    const Range& range, Range& left, Range& right) {
  const std::uint32_t middle = range.begin + split.left_count, buffer = 1 - range.buffer;
  right = {middle, range.end, buffer, range.depth, split.right_area, split.right_box, centers[1]};
  left = {range.begin, middle, buffer, range.depth, split.left_area, split.left_box, centers[0]};
}

/// The halves of a range that nothing tells where to split.
inline void halve(const Buffers& buffers, const Measure& measure, const Range& range, Range& left,
                  Range& right) {
  const std::uint32_t middle = range.begin + range.count() / 2;
  left = right = range;
  left.end = right.begin = middle;
  for (Range* half : {&left, &right}) {
    half->box = bounds(buffers.of(*half), half->count());
    half->area = measure.half_area(half->box);
    half->centers = center_bounds(buffers.of(*half), half->count());
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
