/// Threads that wait at the end of an execution: whether for good.
#pragma once

#include "stress/checker/execution_state.hpp"
#include "stress/checker/loops.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

/// Concludes an execution whose threads do not go on: complete if all have ended, blocked if one
/// waits for what another execution brings, else with a finding that says where they stand.
void conclude_standstill(ExecutionState& state, const Turns& turns, const Loops& loops);

}  // namespace irt::checker
