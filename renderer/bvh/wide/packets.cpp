#include "renderer/bvh/wide/packets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wide/packets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wide/group-inl.hpp"
#include "renderer/bvh/wide/single-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// Where the answers to one query go.
struct ClosestAnswers {
  static constexpr bool any = false;
  Hits& hits;

  HWY_INLINE void put(std::uint32_t lane, const Hit& hit) const {
    hits.t[lane] = hit.t;
    hits.u[lane] = hit.u;
    hits.v[lane] = hit.v;
    hits.triangle[lane] = hit.triangle;
  }
  /// May write lanes past the batch's end: the arrays are padded.
  template <int N>
  HWY_INLINE void put(std::uint32_t first, std::uint32_t /*end*/, const Packet<N>& packet) const {
    packet.t.store(&hits.t[first]);
    packet.u.store(&hits.u[first]);
    packet.v.store(&hits.v[first]);
    packet.triangle.store(&hits.triangle[first]);
  }
};

struct AnyAnswers {
  static constexpr bool any = true;
  std::uint8_t* occluded;

  HWY_INLINE void put(std::uint32_t lane, const Hit& hit) const {
    occluded[lane] = hit.triangle != no_triangle;
  }
  template <int N>
  HWY_INLINE void put(std::uint32_t first, std::uint32_t end, const Packet<N>& packet) const {
    if (end - first == N) return store_bytes(packet.met(), occluded + first);
    const unsigned met = packet.met().bits();
    for (std::uint32_t lane = first; lane < end; ++lane) occluded[lane] = met >> (lane - first) & 1;
  }
};

template <class Answers>
void trace_rays(const WideBvh& bvh, const Rays& rays, const Answers& answers,
                const WideQuery& query) {
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    const TraversalRay ray(rays.ray(lane));
    Hit best = no_hit(ray);
    if (best.t >= 0 && !bvh.nodes.empty()) {
      query.code->single[query.any](bvh, ray, {WideChild::inner(0), 0}, query.probe, best);
    }
    answers.put(lane, best);
  }
}

template <int N, class Answers>
void trace_packets(const WideBvh& bvh, const Rays& rays, const Answers& answers,
                   const WideQuery& query) {
  Packet<N> packets[most_in_group];
  for (std::uint32_t first = 0; first < rays.size; first += most_in_group * N) {
    const std::uint32_t count = std::min(most_in_group, (rays.size - first + N - 1) / N);
    for (std::uint32_t k = 0; k < count; ++k) packets[k].load(rays, first + k * N);
    if (!bvh.nodes.empty()) trace_group(bvh, packets, count, query);
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t begin = first + k * N;
      answers.put(begin, std::min(rays.size, begin + N), packets[k]);
    }
  }
}

template <class Answers>
void trace(const WideBvh& bvh, const WideWay& way, const Rays& rays, const Answers& answers,
           TickProbe* probe) {
  const WideQuery query{static_cast<const KernelCode*>(way.code), Answers::any, probe};
  switch (rays.singly ? 1 : way.width) {
    case 1:
      return trace_rays(bvh, rays, answers, query);
    case 4:
      return trace_packets<4>(bvh, rays, answers, query);
    case 8:
      return trace_packets<8>(bvh, rays, answers, query);
    default:
      return trace_packets<16>(bvh, rays, answers, query);
  }
}

void closest(const WideBvh& bvh, const WideWay& way, const Rays& rays, Hits& hits,
             TickProbe* probe) {
  trace(bvh, way, rays, ClosestAnswers{hits}, probe);
}
void any(const WideBvh& bvh, const WideWay& way, const Rays& rays, std::uint8_t* occluded,
         TickProbe* probe) {
  trace(bvh, way, rays, AnyAnswers{occluded}, probe);
}

const KernelCode& code_of(TriangleKernel kernel) {
  switch (kernel) {
    case TriangleKernel::projection:
      return kernel_code<Projection>;
    case TriangleKernel::kensler_shirley:
      return kernel_code<KenslerShirley>;
    case TriangleKernel::watertight:
      return kernel_code<Watertight>;
    case TriangleKernel::moller_trumbore:
      break;
  }
  return kernel_code<MollerTrumbore>;
}

WideWay way_of(TriangleKernel kernel, unsigned width) {
  if (width == 0) width = static_cast<unsigned>(FloatLayout<16>::per_part);
  return {width, &code_of(kernel), closest, any};
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "renderer/bvh/simd_targets.hpp"

namespace irt {

WideWay wide_way(std::string_view isa, TriangleKernel kernel, unsigned width) {
  using Code = WideWay (*)(TriangleKernel, unsigned);
  static constexpr SimdTarget<Code> targets[] IRT_SIMD_TARGETS(way_of);
  check_packet_width(width);
  return code_for<Code>(isa, targets)(kernel, width);
}

}  // namespace irt
#endif  // HWY_ONCE
