// Several elements in a call, of sizes that differ, among pushes and pops of one.
#include "stress/scenarios/bodies.hpp"

void irt::stress::bulk(Core& core) {
  const WorkerState& self = core.self();
  const auto size = [&] {
    return static_cast<std::size_t>(core.random(8) == 0 ? core.random(Core::most_in_bulk + 1)
                                                        : core.random(6));
  };
  while (core.more()) {
    const bool alone = core.random(4) == 0;
    if (self.pushes && (!self.pops || core.random(2) == 0)) {
      const std::size_t count = size();
      if (alone ? !core.push() : core.push_bulk(count) < count) core.idle();
    } else if (alone ? !core.pop() : core.pop_bulk(size()) == 0) {
      core.idle();
    }
  }
}
