/// Clocks that the C++ library does not have, as those of processor time.
#pragma once

#include <ctime>

namespace irt {

/// What `clock` shows, in seconds (clock_gettime(2)): CLOCK_PROCESS_CPUTIME_ID, for example. 0
/// where there is no such clock.
inline double seconds_by(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace irt
