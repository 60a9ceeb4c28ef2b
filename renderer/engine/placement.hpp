/// Which core a render thread runs on.
#pragma once

namespace irt {

/// Whether this build can bind threads (it has hwloc).
bool can_pin();

/// Binds the calling thread, the `index`-th of its kind, to a hardware thread: every core once
/// before any core's second hardware thread, then from the start. False if the system refuses.
bool pin_this_thread(unsigned index);

}  // namespace irt
