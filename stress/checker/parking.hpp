/// A pop of an empty queue that does not return.
#pragma once

#include "queues/work_queue.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// Whether a thread that is alone with a new queue gets no answer from its pop, which breaks the
/// contract: a pop that waits is `pop_wait`.
bool pop_waits(const QueueEntry& entry, virtual_cores::Module& module);

}  // namespace irt::checker
