// For queues whose `pop_wait` waits: as many waiting pops as pushes, so that none may wait for
// ever; then a few pushes more and the end of it all, which every consumer must hear of.
#include "stress/scenarios/bodies.hpp"

namespace irt::stress {
namespace {

void offer(Core& core) {
  while (!core.push()) core.idle();
}

void close_at_last(Core& core) {
  for (std::uint64_t pause = core.random(20); pause > 0; --pause) core.idle();
  for (std::uint64_t left = core.random(4); left > 0; --left) offer(core);
  core.close();
}

}  // namespace

void parked(Core& core) {
  const WorkerState& self = core.self();
  if (self.pushes) {
    for (std::uint64_t left = self.operations; left > 0; --left) {
      offer(core);
      // Slow enough that consumers wait, now and then.
      for (std::uint64_t pause = core.random(3); pause > 0; --pause) core.idle();
    }
  } else {
    const std::uint64_t all = self.pushers * self.operations;
    const bool takes_one_more = self.workers - 1 - self.worker < all % self.poppers;
    for (std::uint64_t left = all / self.poppers + (takes_one_more ? 1 : 0); left > 0; --left) {
      if (!core.pop_wait()) core.complain("pop_wait answered closed while elements were due");
    }
  }
  core.meet();
  if (self.worker == 0) {
    close_at_last(core);
  } else if (self.pops) {
    while (core.pop_wait()) {
    }
  }
}

void parked_closed_early(Core& core) {
  const WorkerState& self = core.self();
  if (self.worker == 0) {
    for (std::uint64_t left = core.random(self.operations + 1); left > 0; --left) core.push();
    close_at_last(core);
    core.push();
  } else if (!self.pops) {
    while (core.more()) core.push();
  } else {
    while (core.random(4) == 0 ? core.pop() : core.pop_wait()) {
    }
    while (core.pop_wait()) {
    }
  }
}

void parked_for_a_while(Core& core) {
  const WorkerState& self = core.self();
  // From deadlines that have passed already to some that are rarely reached.
  const auto some_time = [&] {
    constexpr std::uint64_t longest = 200'000;  // nanoseconds
    const std::uint64_t dice = core.random(4);
    return static_cast<std::int64_t>(dice == 0 ? 0 : core.random(longest >> 4 * dice));
  };
  while (core.more()) {
    if (self.pushes) {
      core.push();
      for (std::uint64_t pause = core.random(8); pause > 0; --pause) core.idle();
    } else if (core.pop_wait(some_time()) == PopStatus::closed) {
      core.complain("pop_wait answered closed, and nobody closes yet");
    }
  }
  core.meet();
  if (self.worker == 0) {
    close_at_last(core);
  } else if (self.pops) {
    while (core.random(2) == 0 ? core.pop_wait().has_value()
                               : core.pop_wait(some_time()) != PopStatus::closed) {
    }
  }
}

}  // namespace irt::stress
