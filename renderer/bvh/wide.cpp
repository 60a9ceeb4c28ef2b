#include "renderer/bvh/wide.hpp"

#include "renderer/bvh/ray_loop.hpp"
#include "renderer/bvh/wide_build.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wide.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wide_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

template <bool any, class Probe>
Hit trace_ray(const WideBvh& bvh, const Ray& ray, Probe& probe) {
  const TraversalRay traversal(ray);
  Hit best = no_hit(traversal);
  if (best.t >= 0 && !bvh.nodes.empty()) {
    trace_single<any>(bvh, SingleRay(traversal), {WideChild::inner(0), 0}, best, probe);
  }
  return best;
}

void closest(const WideBvh& bvh, const Rays& rays, Hits& hits, TraceProfile* profile) {
  with_profile(profile, [&](auto& probe) HWY_ATTR {
    for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
      const Hit hit = trace_ray<false>(bvh, rays.ray(lane), probe);
      hits.t[lane] = hit.t;
      hits.u[lane] = hit.u;
      hits.v[lane] = hit.v;
      hits.triangle[lane] = hit.triangle;
    }
  });
}

void any(const WideBvh& bvh, const Rays& rays, std::uint8_t* occluded, TraceProfile* profile) {
  with_profile(profile, [&](auto& probe) HWY_ATTR {
    for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
      occluded[lane] = trace_ray<true>(bvh, rays.ray(lane), probe).triangle != no_triangle;
    }
  });
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

Wide::Wide(const Mesh& mesh, Executor& executor) : bvh_(build_wide(mesh, executor)) {}

void Wide::closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const {
  HWY_DYNAMIC_DISPATCH(closest)(bvh_, rays, hits, profile);
}

void Wide::any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
                   TraceProfile* profile) const {
  HWY_DYNAMIC_DISPATCH(any)(bvh_, rays, occluded.data(), profile);
}

}  // namespace irt
#endif
