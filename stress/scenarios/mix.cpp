// Push if you may, pop if you may, as fast as it goes.
#include "stress/scenarios/bodies.hpp"

void irt::stress::mix(Core& core) {
  while (core.more()) {
    bool moved = false;
    if (core.self().pushes) moved = core.push();
    if (core.self().pops) moved = core.pop().has_value() || moved;
    if (!moved) core.idle();
  }
}
