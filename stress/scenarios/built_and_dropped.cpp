// Beside the queue in use, each worker builds queues of its own, uses them a little and drops them
// with elements inside: what queues share (hazard pointers, thread-locals, pools) must bear it.
#include <algorithm>
#include <vector>

#include "stress/scenarios/bodies.hpp"

namespace {

void use_one(irt::stress::Core& core) {
  constexpr std::size_t capacity = 8;
  const auto queue = core.another_queue(1, capacity);
  std::vector<irt::stress::Element> inside;
  std::uint64_t sequence = 0;
  for (std::uint64_t left = core.random(capacity + 1); left > 0; --left, ++sequence) {
    inside.push_back(irt::stress::next_element(core.self().claims, 0, sequence));
    if (!queue->push(0, inside.back()))
      core.complain("a new queue answered full below its capacity");
  }
  for (std::uint64_t left = core.random(inside.size() + 1); left > 0; --left) {
    irt::stress::Element e = 0;
    if (!queue->pop(0, e)) core.complain("a private queue answered empty with elements inside");
    const auto found = std::find(inside.begin(), inside.end(), e);
    if (found == inside.end()) core.complain("a private queue returned a wrong element");
    inside.erase(found);
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
