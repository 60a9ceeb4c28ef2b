/// Waits for another thread that is expected soon, as a lock's next holder does for the present
/// one.
///
/// When to use: what is awaited takes less than a sleep would. When not: it may take long; see
/// `event_count.hpp`.
///
/// How it works: a look, a pause of the processor, another look. Who has paused for some
/// microseconds in vain also gives the processor away between looks from then on, for the thread
/// that is awaited may be one that has none.
#pragma once

#include <thread>

namespace irt {

/// Returns when `distance()` is 0. As long as it is not, so many pauses lie between two looks.
/// Blocking.
template <class Distance>
void spin_until_zero(Distance distance) {
  unsigned pauses_left = 256;
  while (const unsigned far = distance()) {
#if defined(__x86_64__)
    for (unsigned pauses = far; pauses > 0; --pauses) __builtin_ia32_pause();
#endif
    if (far > pauses_left)
      std::this_thread::yield();
    else
      pauses_left -= far;
  }
}

}  // namespace irt
