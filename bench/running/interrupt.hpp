/// Ctrl-C ends a measurement, not what it has measured.
#pragma once

#include <atomic>

namespace irt {

/// From now on the first SIGINT or SIGTERM sets the flag that is returned; a second one kills.
const std::atomic<bool>& watch_for_interrupt();

/// The exit code of a program that Ctrl-C ended.
inline constexpr int exit_interrupted = 130;

}  // namespace irt
