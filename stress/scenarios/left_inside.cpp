// More goes in than comes out, and nobody empties the queue before it is destroyed. Some never pop,
// so that now and then nobody has.
#include "stress/scenarios/bodies.hpp"

void irt::stress::left_inside(Core& core) {
  const WorkerState& self = core.self();
  std::uint64_t pops = self.pops && core.random(2) == 0 ? self.operations / 2 : 0;
  while (core.more() && (self.pushes || pops > 0)) {
    const bool takes = pops > 0 && (!self.pushes || core.random(3) == 0);
    if (takes) --pops;
    const bool done = takes ? core.pop().has_value() : core.push();
    if (!done) core.idle();
  }
}
