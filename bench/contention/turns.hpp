/// Measurements side by side in time: what the machine does meanwhile happens to all of them alike.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "bench/contention/job.hpp"

namespace irt::contention {

/// How long one runs at a time.
struct Turn {
  double seconds = 0.008;
  double settling_seconds = 0.001;  ///< before, while caches fill; not part of any figure
};

/// The turns of `threads` threads on `processors`. The pace of a machine wanders over some hundred
/// milliseconds, so that a lap of a few turns of the default length falls within one, and what a
/// turn costs on top is small beside it. More threads than processors need longer ones: until each
/// has had the slices of time that the scheduler gives it, no lock holder has yet been put off.
Turn turn_of(unsigned threads, unsigned processors);

/// Turns that make up an interval of `seconds`; at least one.
unsigned turns_in(double seconds, const Turn& turn);

/// Measures `jobs`, which have as many turns each, in a process each that runs `program`. One after
/// the other is started, makes its queue, warms up and is stopped; then they take turns, in an
/// order drawn from `seed` for each lap, every second lap in the reverse order of the one before,
/// so that a pace that drifts favours none. Only one process runs at a time. Calls `done(i,
/// sample)` for each of `jobs` as they end: one that dies or hangs does so at once, and the others
/// go on. Where `cancel` is set all are killed and no more calls come.
///
/// Throws std::runtime_error where no process can be started.
void measure_in_turns(const std::filesystem::path& program, std::span<const Job> jobs,
                      std::uint64_t seed,
                      const std::function<void(std::size_t, const Sample&)>& done,
                      const std::atomic<bool>& cancel);

}  // namespace irt::contention
