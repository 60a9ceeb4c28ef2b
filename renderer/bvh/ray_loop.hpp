/// Timing a traversal from within, at no cost where nobody asks.
#pragma once

#include <cstdint>

#include "renderer/bvh/accelerator.hpp"
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

/// The probe for code that asks at run time whether there is one.
inline TickProbe* tick_probe(NoProbe& /*none*/) {
  return nullptr;
}
inline TickProbe* tick_probe(TickProbe& probe) {
  return &probe;
}

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

}  // namespace irt
