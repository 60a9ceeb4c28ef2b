#include "stress/mutants/scenarios.hpp"

#include <algorithm>
#include <array>
#include <atomic>

namespace irt::stress {
namespace {

/// What the workers of a frame tell each other; read behind the barrier that ends the frame.
struct FrameStamps {
  std::atomic<Stamp> told_over{0};
  std::atomic<Stamp> last_push{0};
};
constexpr unsigned most_workers = 64;
std::array<FrameStamps, most_workers> stamps;

/// Far above any error of the clock.
constexpr Stamp clearly = 10'000;

}  // namespace

void owner_and_thieves(Core& core) {
  if (core.self().worker != 0) {
    while (core.more()) core.pop();
    return;
  }
  while (core.more()) {
    std::uint64_t inside = 0;
    for (std::uint64_t left = 1 + core.random(3); left > 0; --left) inside += core.push() ? 1 : 0;
    for (; inside > 0; --inside) core.pop();
  }
}

void frames(Core& core) {
  FrameStamps& own = stamps[core.self().worker];
  for (int frame = 0; frame < 4; ++frame) {
    own.last_push = 0;
    if (core.self().worker == 0) {
      for (int root = 0; root < 2; ++root) core.push();
    }
    core.meet();
    while (core.pop()) {
      // A task takes its time before it adds children.
      for (std::uint64_t work = core.random(2'000); work > 0; --work) asm volatile("");
      for (std::uint64_t child = core.random(3); child > 0 && core.more(); --child) {
        own.last_push = core.stamp();
        core.push();
      }
    }
    own.told_over = core.stamp();
    core.meet();
    if (core.self().worker == 0) {
      Stamp first_told = never;
      Stamp last_push = 0;
      for (unsigned w = 0; w < core.self().workers; ++w) {
        first_told = std::min(first_told, stamps[w].told_over.load());
        last_push = std::max(last_push, stamps[w].last_push.load());
      }
      if (last_push > first_told + clearly) {
        core.complain("a worker was told that the frame is over before another added tasks to it");
      }
    }
    core.meet();
  }
}

}  // namespace irt::stress
