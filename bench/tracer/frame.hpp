/// A whole picture by the simplest code there is, the same for every contestant.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/tracer/contestant.hpp"
#include "bench/tracer/measurement.hpp"
#include "renderer/bvh/executor.hpp"

namespace irt::bench {

/// Makes primary rays, traces and shades them: a shadow ray to every light and a mirrored ray at
/// every hit; what the mirrored ray meets is lit without shadows. A task is a tile, and tasks are
/// handed out by one atomic counter. Returns the brightness per pixel; with `times`, a round of how
/// long the tasks took is added to them.
std::vector<float> trace_frame(const Scene& scene, std::uint32_t side, const Contestant& contestant,
                               Executor& executor, TaskTimes* times = nullptr);

}  // namespace irt::bench
