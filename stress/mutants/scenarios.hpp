/// Patterns of use that only queues of this room need: a deque with an owner, a frame that ends.
#pragma once

#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// Worker 0 pushes a few and takes them again; the others only take.
void owner_and_thieves(Core& core);

/// The renderer's frame on a pool whose `pop` says when the frame is over: complains when a worker
/// was told so although another then pushed a task of the same frame.
void frames(Core& core);

}  // namespace irt::stress
