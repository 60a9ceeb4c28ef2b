// The renderer's own shape: a frame starts with a few tasks, each task leads to at most six more
// (fewer, the deeper), and who finds the queue empty a few times in a row goes to the barrier.
#include "stress/scenarios/bodies.hpp"

void irt::stress::renderer(Core& core) {
  constexpr int frames = 3;
  constexpr std::uint64_t roots = 4;
  constexpr int patience = 3;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::uint64_t i = 0; i < roots && core.more(); ++i) core.push();
    core.meet();
    for (int failed = 0; failed < patience && core.more();) {
      const std::optional<Element> task = core.pop();
      if (!task) {
        ++failed;
        core.idle();
        continue;
      }
      failed = 0;
      const std::uint64_t children = core.random(3) == 0 ? core.random(7) : 0;
      for (std::uint64_t child = 0; child < children && core.more(); ++child) {
        if (!core.push()) break;  // full: the tasks that were inside come first
      }
    }
    // Who adds also drains: a worker may leave early, the frame is complete all the same.
    while (core.more() && core.pop()) {
    }
    core.meet();
  }
}
