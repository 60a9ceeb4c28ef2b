// The queue is full nearly all the time: each pop frees a place that several pushes want.
#include "stress/scenarios/bodies.hpp"

void irt::stress::full_ring(Core& core) {
  while (core.more()) {
    if (core.self().pushes) {
      for (std::uint64_t left = 1 + core.random(8); left > 0 && core.more(); --left) core.push();
    }
    if (core.self().pops) {
      core.pop();
      for (std::uint64_t pause = core.random(3); pause > 0; --pause) core.idle();
    }
  }
}
