/// Stopping threads in the middle of an operation, and asking them where they stand.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stress/threads/slot.hpp"

namespace irt::stress {

/// Installs the handlers and warms up the unwinder. Once per process, before worker threads start.
void install_signals();

/// Makes `slot`'s thread sleep for `nanoseconds` where it stands, if it is inside an operation and
/// not in the allocator (whose locks are nobody's claim).
void stall(const Slot& slot, std::uint64_t nanoseconds);

/// Holds `slot`'s thread where it stands until `release()`. Waits up to a millisecond; false when
/// the thread did not stand in the queue's own code (`Standing::own`, for which `Slot::base` must
/// be set) and runs on. The trace of a held thread is in the slot.
bool suspend(Slot& slot);

/// Lets the thread that `suspend()` holds go on.
void release(Slot& slot);

/// Asks a thread where it stands: `Slot::trace` and `Slot::standing`. False if it does not answer
/// within half a second.
bool ask_trace(Slot& slot);

/// Function names (and lines, where the program has them) of a trace, innermost first, without the
/// signal handler's own frames. Uses addr2line where it is installed.
std::vector<std::string> describe(const Trace& trace);

/// On a fatal signal, writes `{"crash":N,"trace":[...]}` to `descriptor` and exits. Not under
/// sanitizers, which have their own report.
void report_crashes_to(int descriptor);

}  // namespace irt::stress
