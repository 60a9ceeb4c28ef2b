#include "bench/contention/busy_wait.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

namespace irt::contention {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int rounds = 50;

// Nanoseconds of the shortest round of `waits` waits.
double shortest_round(std::uint64_t waits, std::uint64_t steps) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const Clock::time_point begin = Clock::now();
    for (std::uint64_t i = 0; i < waits; ++i) busy_wait(steps);
    const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
    shortest = std::min(shortest, taken.count());
  }
  return shortest;
}

}  // namespace

Pace measure_pace() {
  constexpr std::uint64_t steps = 100'000;
  const double step_ns = shortest_round(1, steps) / static_cast<double>(steps);
  return {.fixed_ns = std::max(0.0, measure_wait_ns(1) - step_ns), .step_ns = step_ns};
}

double measure_wait_ns(std::uint64_t steps) {
  const std::uint64_t waits = std::clamp<std::uint64_t>(100'000 / (steps + 1), 1, 10'000);
  return shortest_round(waits, steps) / static_cast<double>(waits);
}

}  // namespace irt::contention
