#include "renderer/bvh/wide.hpp"

#include "renderer/bvh/ray_loop.hpp"
#include "renderer/bvh/wide_build.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wide_group-inl.h"
#include "renderer/bvh/wide_packet-inl.h"
#include "renderer/bvh/wide_single-inl.h"

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
  template <class D>
  HWY_INLINE void put(std::uint32_t first, std::uint32_t /*end*/, const Packet<D>& packet) const {
    const D d;
    hn::Store(packet.t, d, &hits.t[first]);
    hn::Store(packet.u, d, &hits.u[first]);
    hn::Store(packet.v, d, &hits.v[first]);
    hn::Store(packet.triangle, hn::Rebind<std::uint32_t, D>(), &hits.triangle[first]);
  }
};

struct AnyAnswers {
  static constexpr bool any = true;
  std::uint8_t* occluded;

  HWY_INLINE void put(std::uint32_t lane, const Hit& hit) const {
    occluded[lane] = hit.triangle != no_triangle;
  }
  template <class D>
  HWY_INLINE void put(std::uint32_t first, std::uint32_t end, const Packet<D>& packet) const {
    const unsigned met = packet.met();
    for (std::uint32_t lane = first; lane < end; ++lane) occluded[lane] = met >> (lane - first) & 1;
  }
};

template <class Answers, class Probe>
void trace_rays(const WideBvh& bvh, const Rays& rays, const Answers& answers, Probe& probe) {
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    const TraversalRay ray(rays.ray(lane));
    Hit best = no_hit(ray);
    if (best.t >= 0) {
      trace_single<Answers::any>(bvh, SingleRay(ray), {WideChild::inner(0), 0}, best, probe);
    }
    answers.put(lane, best);
  }
}

template <int width, class Answers, class Probe>
void trace_packets(const WideBvh& bvh, const Rays& rays, const WideOptions& options,
                   const Answers& answers, Probe& probe) {
  using D = hn::CappedTag<float, width>;
  constexpr std::uint32_t lanes = Packet<D>::lanes;
  const TogetherLimits limits;
  const std::uint32_t most = options.groups ? GroupTrace<false, false, D, Probe>::most : 1;
  Packet<D> packets[GroupTrace<false, false, D, Probe>::most];
  for (std::uint32_t first = 0; first < rays.size; first += most * lanes) {
    const std::uint32_t count = std::min(most, (rays.size - first + lanes - 1) / lanes);
    for (std::uint32_t k = 0; k < count; ++k) packets[k].load(rays, first + k * lanes);
    if (options.groups) {
      trace_group<Answers::any>(bvh, packets, count, limits, probe);
    } else {
      trace_packet<Answers::any>(bvh, packets[0], limits, probe);
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t begin = first + k * lanes;
      answers.put(begin, std::min(rays.size, begin + lanes), packets[k]);
    }
  }
}

template <class Answers>
void trace(const WideBvh& bvh, const Rays& rays, const WideOptions& options, const Answers& answers,
           TraceProfile* profile) {
  if (bvh.nodes.empty()) {
    for (std::uint32_t lane = 0; lane < rays.size; ++lane) answers.put(lane, {});
    return;
  }
  with_profile(profile, [&](auto& probe) HWY_ATTR {
    switch (options.width) {
      case 1:
        return trace_rays(bvh, rays, answers, probe);
      case 4:
        return trace_packets<4>(bvh, rays, options, answers, probe);
      case 8:
        return trace_packets<8>(bvh, rays, options, answers, probe);
      default:
        return trace_packets<16>(bvh, rays, options, answers, probe);
    }
  });
}

void closest(const WideBvh& bvh, const Rays& rays, const WideOptions& options, Hits& hits,
             TraceProfile* profile) {
  trace(bvh, rays, options, ClosestAnswers{hits}, profile);
}

void any(const WideBvh& bvh, const Rays& rays, const WideOptions& options, std::uint8_t* occluded,
         TraceProfile* profile) {
  trace(bvh, rays, options, AnyAnswers{occluded}, profile);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(closest);
HWY_EXPORT(any);

Wide::Wide(const Mesh& mesh) {
  ThreadExecutor executor;
  bvh_ = build_wide(mesh, executor);
}

Wide::Wide(const Mesh& mesh, Executor& executor, const WideOptions& options)
    : bvh_(build_wide(mesh, executor)), options_(options) {}

void Wide::closest_hit(const Rays& rays, Hits& hits, const WideOptions& options,
                       TraceProfile* profile) const {
  HWY_DYNAMIC_DISPATCH(closest)(bvh_, rays, options, hits, profile);
}

void Wide::any_hit(const Rays& rays, std::span<std::uint8_t> occluded, const WideOptions& options,
                   TraceProfile* profile) const {
  HWY_DYNAMIC_DISPATCH(any)(bvh_, rays, options, occluded.data(), profile);
}

}  // namespace irt
#endif
