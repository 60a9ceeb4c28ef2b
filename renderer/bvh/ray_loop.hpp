/// The two queries of an accelerator from one function that traces a single ray.
#pragma once

#include <cstdint>
#include <span>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/stopwatch.hpp"

namespace irt {

/// Costs nothing: what an unprofiled traversal is compiled with.
struct NoProbe {
  void test_begins() {}
  void test_ends() {}
};

/// Adds up the time between `test_begins` and `test_ends`, and counts the pairs.
struct TickProbe {
  std::uint64_t ticks = 0, tests = 0, begun = 0;
  void test_begins() { begun = ticks_now(); }
  void test_ends() {
    ticks += ticks_now() - begun;
    ++tests;
  }
};

/// Calls `trace(probe)`, under the clock where `profile` is given.
template <class Trace>
void with_profile(TraceProfile* profile, Trace trace) {
  if (profile == nullptr) {
    NoProbe none;
    trace(none);
    return;
  }
  const double nanoseconds = nanoseconds_per_tick();
  const std::uint64_t nothing = ticks_of_nothing();
  TickProbe probe;
  const std::uint64_t start = ticks_now();
  trace(probe);
  const std::uint64_t total = ticks_now() - start;
  // A pair of readings costs `nothing` inside the span and about as much outside of it.
  const std::uint64_t inside = probe.tests * nothing;
  const std::uint64_t intersect = probe.ticks > inside ? probe.ticks - inside : 0;
  const std::uint64_t rest = intersect + 2 * inside;
  const std::uint64_t traverse = total > rest ? total - rest : 0;
  profile->intersect_ns += static_cast<std::uint64_t>(static_cast<double>(intersect) * nanoseconds);
  profile->traverse_ns += static_cast<std::uint64_t>(static_cast<double>(traverse) * nanoseconds);
}

/// An accelerator that traces one ray after the other. `Structure` has
/// `template <bool any, class Probe> Hit trace(const TraversalRay&, Probe&) const`; with `any` it
/// may stop at the first hit that it finds.
template <class Structure>
class SingleRayAccelerator : public Accelerator {
 public:
  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const final {
    with_profile(profile, [&](auto& probe) {
      for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
        const Hit hit = self().template trace<false>(TraversalRay(rays.ray(lane)), probe);
        hits.t[lane] = hit.t;
        hits.u[lane] = hit.u;
        hits.v[lane] = hit.v;
        hits.triangle[lane] = hit.triangle;
      }
    });
  }

  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile) const final {
    with_profile(profile, [&](auto& probe) {
      for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
        const Hit hit = self().template trace<true>(TraversalRay(rays.ray(lane)), probe);
        occluded[lane] = hit.triangle != no_triangle;
      }
    });
  }

 private:
  const Structure& self() const { return static_cast<const Structure&>(*this); }
};

}  // namespace irt
