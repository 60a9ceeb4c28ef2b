// One in, one out: the queue holds at most one element per worker and is empty again and again.
#include "stress/scenarios/bodies.hpp"

void irt::stress::ping_pong(Core& core) {
  while (core.more()) {
    if (!core.push()) {
      core.idle();
      continue;
    }
    while (core.more() && !core.pop()) core.idle();
  }
}
