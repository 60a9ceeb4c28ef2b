/// Queues whose pop waits for an element instead of answering *empty*, until the queue is closed.
///
/// The contract does not know them, so nobody can claim to be one; they are told by what they do. A
/// queue that neither answers nor is closed by `close_word` gets no special treatment: its pop
/// hangs.
#pragma once

#include <string>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// Whether the pop of an empty queue waits, and answers *empty* once `close_word` was pushed.
bool pop_waits_until_closed(const QueueEntry& entry, virtual_cores::Module& module);

/// Shapes for such a queue: each pop gets an element or the queue is closed, before the threads end
/// or after.
std::vector<std::string> parking_battery(const Claims& claims);

}  // namespace irt::checker
