/// A clock for spans of some tens of nanoseconds, as `TraceProfile` needs.
#pragma once

#include <cstdint>

namespace irt {

/// The processor's time stamp where there is one, else the steady clock; in ticks.
std::uint64_t ticks_now();

/// Nanoseconds per tick, measured once against the steady clock (some 2 ms on the first call).
double nanoseconds_per_tick();

/// Ticks that an empty pair of `ticks_now()` shows: to be taken off every measured span.
std::uint64_t ticks_of_nothing();

}  // namespace irt
