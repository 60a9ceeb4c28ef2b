/// `irt simulate --validate`: simulated beside measured, here and as others have published it.
#pragma once

#include <atomic>

#include "bench/many_core/sweep.hpp"

namespace irt::many_core {

/// Prints two tables: this machine, simulated from the profile `options.machines` names first and
/// measured with real threads at one and two cores; and the published curves of published.json,
/// with the ratio of each point and the rankings. Returns 1 where a published point is outside of
/// its band.
int validate(const SweepOptions& options, const std::atomic<bool>& interrupted);

}  // namespace irt::many_core
