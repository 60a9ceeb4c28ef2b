/// What the kernel knows about a thread of this process.
#pragma once

#include <cstdint>
#include <optional>
#include <sys/types.h>

namespace irt::stress {

/// Processor time of `thread` so far in nanoseconds; nothing if it cannot be read.
std::optional<std::uint64_t> cpu_time(pid_t thread);

/// Whether `thread` waits for something (a lock, a sleep), not merely for a processor.
bool sleeps(pid_t thread);

}  // namespace irt::stress
