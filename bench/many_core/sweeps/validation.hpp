/// `irt simulate --validate`: simulated beside measured, here and as others have published it.
#pragma once

#include <atomic>

#include "bench/many_core/sweeps/sweep.hpp"

namespace irt::many_core {

/// Prints two tables: this machine, measured with real threads at one and two cores and simulated
/// from the profile that `options.machines` names first, or, where it names none, from the one that
/// `irt calibrate` has left in `options.out`, or from one that is calibrated now; and the published
/// curves of published.json, with the ratio of each point and the rankings. Returns 1 where a
/// published point is outside of its band.
int validate(const SweepOptions& options, const std::atomic<bool>& interrupted);

}  // namespace irt::many_core
