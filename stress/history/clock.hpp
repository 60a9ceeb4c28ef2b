/// Stamps for operation logs: the invariant time-stamp counter, without a shared counter.
///
/// A shared counter would order all operations by itself and so hide the very weak-memory bugs
/// that the logs are kept for. The counters of different cores are read independently; how far
/// they may be apart is measured once (`calibrate`) and given to the oracles as an error.
#pragma once

#include <ctime>
#include <string>

#include "stress/history/operation.hpp"

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace irt::stress {

/// How good the stamps of this machine are.
struct ClockQuality {
  bool time_stamp_counter = false;  ///< else CLOCK_MONOTONIC
  double ticks_per_nanosecond = 1;
  Stamp error = 0;  ///< ticks; two stamps order two moments only if they are 2 x error apart
  std::string description;  ///< one line for reports
};

namespace detail {
/// Whether the processor says that its counter runs at one rate and never stops.
bool invariant_counter();
inline const bool use_counter = invariant_counter();

inline Stamp monotonic_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<Stamp>(now.tv_sec) * 1'000'000'000U + static_cast<Stamp>(now.tv_nsec);
}
}  // namespace detail

/// The moment before an operation: nothing of what follows has started.
inline Stamp stamp_before() {
#if defined(__x86_64__)
  if (detail::use_counter) {
    const Stamp now = __rdtsc();
    _mm_lfence();
    return now;
  }
#endif
  return detail::monotonic_nanoseconds();
}

/// The moment after an operation: all that precedes has been executed. Its stores may still be
/// on their way to other cores; a queue that claims real-time order must answer for that.
inline Stamp stamp_after() {
#if defined(__x86_64__)
  if (detail::use_counter) {
    unsigned processor = 0;
    const Stamp now = __rdtscp(&processor);
    _mm_lfence();
    return now;
  }
#endif
  return detail::monotonic_nanoseconds();
}

/// Measures the counters of all cores this process may use against the first one's, by messages
/// to and fro. Takes about a millisecond per core; call it before other threads exist.
ClockQuality calibrate();

}  // namespace irt::stress
