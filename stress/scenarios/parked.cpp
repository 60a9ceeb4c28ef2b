// For queues whose `pop` waits: as many pops as pushes, so that none may wait for ever; then a few
// pushes more and the end of it all, which every consumer must hear of.
#include "stress/scenarios/bodies.hpp"

void irt::stress::parked(Core& core) {
  const WorkerState& self = core.self();
  const auto offer = [&] {
    while (!core.push()) core.idle();
  };
  if (self.pushes) {
    for (std::uint64_t left = self.operations; left > 0; --left) {
      offer();
      // Slow enough that consumers wait, now and then.
      for (std::uint64_t pause = core.random(3); pause > 0; --pause) core.idle();
    }
  } else {
    const std::uint64_t all = self.pushers * self.operations;
    const bool takes_one_more = self.workers - 1 - self.worker < all % self.poppers;
    for (std::uint64_t left = all / self.poppers + (takes_one_more ? 1 : 0); left > 0; --left) {
      if (!core.pop()) core.complain("pop answered empty, not closed, while elements were due");
    }
  }
  core.meet();
  if (self.worker == 0) {
    for (std::uint64_t pause = core.random(20); pause > 0; --pause) core.idle();
    for (std::uint64_t left = core.random(4); left > 0; --left) offer();
    core.command(close_word);
  } else if (self.pops) {
    while (core.pop()) {
    }
  }
}
