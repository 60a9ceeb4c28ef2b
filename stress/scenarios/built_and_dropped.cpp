// Beside the queue in use, each worker builds queues of its own, uses them a little and drops them
// with elements inside: what queues share (hazard pointers, thread-locals, pools) must bear it.
#include <algorithm>
#include <vector>

#include "stress/scenarios/bodies.hpp"

namespace {

void use_one(irt::stress::Core& core) {
  constexpr std::size_t capacity = 8;
  const auto queue = core.another_queue(1, capacity);
  const std::uint64_t pushed = core.random(capacity + 1);
  for (std::uint64_t i = 0; i < pushed; ++i) {
    if (!queue->push(0, i)) core.complain("a new queue answered full below its capacity");
  }
  std::vector<bool> seen(pushed, false);
  for (std::uint64_t left = core.random(pushed + 1); left > 0; --left) {
    irt::stress::Element e = 0;
    if (!queue->pop(0, e)) core.complain("a private queue answered empty with elements inside");
    if (e >= pushed || seen[e]) core.complain("a private queue returned a wrong element");
    seen[e] = true;
  }
}

}  // namespace

void irt::stress::built_and_dropped(Core& core) {
  while (core.more()) {
    if (core.random(8) == 0) use_one(core);
    if (!core.push()) core.idle();
    if (!core.pop()) core.idle();
  }
}
