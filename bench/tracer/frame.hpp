/// A whole picture by the simplest code there is, the same for every contestant.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/tracer/contestant.hpp"
#include "renderer/bvh/executor.hpp"

namespace irt::bench {

/// Makes primary rays, traces and shades them: a shadow ray to every light and a mirrored ray at
/// every hit; what the mirrored ray meets is lit without shadows. A task is a tile, and tasks are
/// handed out by one atomic counter. Returns the brightness per pixel.
std::vector<float> trace_frame(const Scene& scene, std::uint32_t side, const Contestant& contestant,
                               Executor& executor);

}  // namespace irt::bench
