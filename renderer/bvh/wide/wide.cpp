#include "renderer/bvh/wide/wide.hpp"

#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide/build.hpp"
#include "renderer/bvh/wide/refit.hpp"

namespace irt {

Wide::Wide(const Mesh& mesh, const AcceleratorOptions& options)
    : way_(wide_way(options.isa, options.kernel, options.width)) {
  if (options.executor != nullptr) {
    bvh_ = build_wide(mesh, *options.executor);
    return;
  }
  ThreadExecutor executor;
  bvh_ = build_wide(mesh, executor);
}

bool Wide::refit(const Mesh& mesh, Executor& executor) {
  refit_wide(bvh_, mesh, executor);
  return true;
}

void Wide::closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const {
  with_profile(profile,
               [&](auto& probe) { way_.closest(bvh_, way_, rays, hits, tick_probe(probe)); });
}

void Wide::any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
                   TraceProfile* profile) const {
  with_profile(profile, [&](auto& probe) {
    way_.any(bvh_, way_, rays, occluded.data(), tick_probe(probe));
  });
}

}  // namespace irt
