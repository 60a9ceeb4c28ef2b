// Many pushes in a row, then a pause; pops until the queue is empty, then a pause.
#include "stress/scenarios/bodies.hpp"

void irt::stress::bursts(Core& core) {
  while (core.more()) {
    if (core.self().pushes) {
      for (std::uint64_t left = 1 + core.random(100); left > 0 && core.more(); --left) {
        if (!core.push()) break;
      }
    }
    if (core.self().pops) {
      while (core.more() && core.pop()) {
      }
    }
    core.idle();
  }
}
