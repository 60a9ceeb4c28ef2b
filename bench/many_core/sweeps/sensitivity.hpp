/// `irt simulate --sensitivity`: which conclusions survive what is not known of a machine.
#pragma once

#include <atomic>

#include "bench/many_core/sweeps/sweep.hpp"

namespace irt::many_core {

/// For every machine and core count of the options: of each two queues, which is the faster one;
/// once as the profile has it, and once for each end of the range of each of its figures. Prints a
/// line for each pair: *holds* if the faster one is so throughout, by a twentieth at least;
/// *depends on* the figures that turn it round; *too close* where the profile's own figures leave
/// less than a twentieth. Writes `OUT/sensitivity.json`. Returns the exit code.
int sensitivity(const SweepOptions& options, const std::atomic<bool>& interrupted);

}  // namespace irt::many_core
