/// Up to 256 rays at once through Wald's hierarchy (Wald, Boulos, Shirley 2007, section 4): SIMD
/// packets in a row, of which the first that is still active speaks for the rest. Included once per
/// target.
///
/// A node is entered as soon as the first active packet enters it; else it is tried to be skipped
/// for all by interval arithmetic over all rays; else the next packet that enters becomes the first
/// active one. In a leaf all packets from there on meet the triangles.
///
/// The interval bounds are made of the operations of `slab` on extreme values. Those round
/// monotonically, so nothing that a ray enters is skipped, to the last bit.
#if defined(IRT_WALD_PACKETS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WALD_PACKETS_INL
#undef IRT_WALD_PACKETS_INL
#else
#define IRT_WALD_PACKETS_INL
#endif

#include <algorithm>
#include <bit>
#include <cstring>

#include "renderer/bvh/wald_packets.hpp"
#include "renderer/tracing/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

template <class Kernel, int N, bool occlusion>
class WaldTracer {
 public:
  static constexpr std::uint32_t most = 256;

  WaldTracer(WaldView tree, TickProbe* probe) : tree_(tree), probe_(probe) {}

  /// Traces `count` rays from `begin` on; the answers are in `t`, `u`, `v` and `triangle`.
  void trace(const Rays& rays, std::uint32_t begin, std::uint32_t count) {
    load(rays, begin, count);
    if (!any_alive_ || tree_.nodes.empty()) return;
    Pending stack[wald_most_depth + 2];
    Pending* top = stack;
    *top++ = {0, 0};
    while (top != stack) {
      const Pending at = *--top;
      const WaldNode& node = tree_.nodes[at.node];
      const std::uint32_t first = first_active(node, at.first);
      if (first == packets_) continue;
      if (node.triangles > 0) {
        if (probe_ != nullptr) probe_->test_begins();
        meet_leaf(node, first);
        if (probe_ != nullptr) probe_->test_ends();
      } else {
        const std::uint32_t falling = inverse_[node.axis][first * N] < 0 ? 1 : 0;
        const std::uint32_t near = node.low_child ^ falling;
        *top++ = {node.first + (near ^ 1), first};
        *top++ = {node.first + near, first};
      }
    }
  }

  alignas(64) float t[most], u[most], v[most];
  std::uint32_t triangle[most];

 private:
  using Lanes = Floats<N>;
  struct Pending {
    std::uint32_t node, first;
  };
  /// Bounds over all rays along one axis; of no use where directions differ in sign.
  struct AxisBounds {
    float near_origin, far_origin, least_inverse, most_inverse;
    bool falling, mixed;
  };

  HWY_INLINE void load(const Rays& rays, std::uint32_t begin, std::uint32_t count) {
    packets_ = (count + N - 1) / N;
    any_alive_ = false;
    Box origins, inverses;
    for (std::uint32_t lane = 0; lane < packets_ * N; ++lane) {
      // A lane without a ray, or with one that can meet nothing, enters no box: its `t` is -1.
      TraversalRay ray(lane < count ? rays.ray(begin + lane) : Ray{{}, {1, 1, 1}, -1});
      if (ray.limit < 0) ray = TraversalRay(Ray{{}, {1, 1, 1}, -1});
      if (ray.limit >= 0) {
        any_alive_ = true;
        origins.grow(ray.origin);
        inverses.grow(ray.inverse);
      }
      for (int axis = 0; axis < 3; ++axis) {
        origin_[axis][lane] = ray.origin[axis];
        direction_[axis][lane] = ray.direction[axis];
        inverse_[axis][lane] = ray.inverse[axis];
      }
      t[lane] = end_[lane] = ray.limit;
      triangle[lane] = no_triangle;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const bool falling = inverses.lo[axis] < 0;
      bounds_[axis] = {falling ? origins.lo[axis] : origins.hi[axis],
                       falling ? origins.hi[axis] : origins.lo[axis],
                       inverses.lo[axis],
                       inverses.hi[axis],
                       falling,
                       falling && inverses.hi[axis] > 0};
    }
  }

  /// The first packet from `first` on that enters the node's box; `packets_` if none does.
  [[nodiscard]] HWY_INLINE std::uint32_t first_active(const WaldNode& node,
                                                      std::uint32_t first) const {
    if (enters(node, first)) return first;
    if (all_miss(node)) return packets_;
    for (++first; first < packets_; ++first) {
      if (enters(node, first)) break;
    }
    return first;
  }

  [[nodiscard]] HWY_INLINE bool enters(const WaldNode& node, std::uint32_t packet) const {
    Lanes entry, exit;
    slab_lanes(node.box(), packet, entry, exit);
    return any(entry <= lesser(exit, Lanes::load(t + packet * N)));
  }

  /// irt::slab per lane, operation by operation.
  HWY_INLINE void slab_lanes(const Box& box, std::uint32_t packet, Lanes& entry,
                             Lanes& exit) const {
    Lanes near[3], far[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes origin = Lanes::load(origin_[axis] + packet * N);
      const Lanes inverse = Lanes::load(inverse_[axis] + packet * N);
      const Lanes t0 = (Lanes(box.lo[axis]) - origin) * inverse;
      const Lanes t1 = (Lanes(box.hi[axis]) - origin) * inverse;
      near[axis] = lesser(t0, t1);
      far[axis] = greater(t0, t1);
    }
    entry = greater(greater(near[0], near[1]), greater(near[2], Lanes(0.0f)));
    exit = lesser(lesser(far[0], far[1]), far[2]) * Lanes(exit_widening);
  }

  [[nodiscard]] HWY_INLINE bool all_miss(const WaldNode& node) const {
    float entry = 0, exit = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const AxisBounds& b = bounds_[axis];
      if (b.mixed) continue;
      const float to_near = (b.falling ? node.box_max : node.box_min)[axis] - b.near_origin;
      const float to_far = (b.falling ? node.box_min : node.box_max)[axis] - b.far_origin;
      entry = std::max(entry, std::min(to_near * b.least_inverse, to_near * b.most_inverse));
      exit = std::min(exit, std::max(to_far * b.least_inverse, to_far * b.most_inverse));
    }
    return entry > exit * exit_widening;
  }

  [[nodiscard]] HWY_INLINE VecOf<Lanes> lanes(const float (&from)[3][most],
                                              std::uint32_t packet) const {
    return {Lanes::load(from[0] + packet * N), Lanes::load(from[1] + packet * N),
            Lanes::load(from[2] + packet * N)};
  }

  HWY_INLINE void meet_leaf(const WaldNode& node, std::uint32_t first) {
    for (std::uint32_t packet = first; packet < packets_; ++packet) {
      if (packet != first && !enters(node, packet)) continue;
      const auto line = Kernel::template prepare<Lanes>(LineOf<Lanes>{
          lanes(origin_, packet), lanes(direction_, packet), Lanes::load(end_ + packet * N)});
      for (std::uint32_t i = 0; i < node.triangles; ++i) {
        const WaldTriangle& one = tree_.triangles[node.first + i];
        const CornersOf<Lanes> corners{broadcast<Lanes>(one.corners.a),
                                       broadcast<Lanes>(one.corners.b),
                                       broadcast<Lanes>(one.corners.c)};
        const CrossingOf<Lanes> crossing =
            cross_at<Kernel, Lanes>(Kernel::template prepare<Lanes>(corners), line);
        if (any(crossing.met)) accept(crossing, one, packet);
      }
    }
  }

  /// irt::meet for the lanes that cross `one`.
  HWY_INLINE void accept(const CrossingOf<Lanes>& crossing, const WaldTriangle& one,
                         std::uint32_t packet) {
    Lanes entry, exit;
    slab_lanes(padded_bounds(one.corners), packet, entry, exit);
    const Lanes at = select(crossing.t < entry, entry, select(crossing.t < exit, crossing.t, exit));
    const std::uint32_t first = packet * N;
    std::uint32_t bits = both(both(crossing.met, entry <= exit),
                              both(at > Lanes(0.0f), at <= Lanes::load(t + first)))
                             .bits();
    if (bits == 0) return;
    alignas(64) float ts[N], us[N], vs[N];
    at.store(ts);
    crossing.u.store(us);
    crossing.v.store(vs);
    for (; bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(bits));
      const std::uint32_t lane = first + i;
      if (ts[i] == t[lane] && one.index > triangle[lane]) continue;
      t[lane] = occlusion ? -1.0f : ts[i];
      u[lane] = us[i];
      v[lane] = vs[i];
      triangle[lane] = one.index;
    }
  }

  WaldView tree_;
  TickProbe* probe_;
  std::uint32_t packets_ = 0;
  bool any_alive_ = false;
  AxisBounds bounds_[3];
  alignas(64) float origin_[3][most], direction_[3][most], inverse_[3][most], end_[most];
};

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
