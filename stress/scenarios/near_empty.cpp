// The queue is empty nearly all the time: most pops fail, and each push meets waiting consumers.
#include "stress/scenarios/bodies.hpp"

void irt::stress::near_empty(Core& core) {
  while (core.more()) {
    if (core.self().pushes) {
      core.push();
      for (std::uint64_t pause = core.random(4); pause > 0; --pause) core.idle();
    }
    if (core.self().pops) {
      for (std::uint64_t left = 1 + core.random(8); left > 0 && core.more(); --left) core.pop();
    }
  }
}
