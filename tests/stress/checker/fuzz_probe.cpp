// Runs little programs given as data: the fuel for comparing searches with each other.

#include <atomic>

#include "tests/stress/checker/fuzz.hpp"

namespace {

using irt::fuzz::Step;

std::atomic<int> variables[2];
int seen[irt::fuzz::max_threads][irt::fuzz::max_steps];

int run(const Step& step) {
  std::atomic<int>& v = variables[step.variable];
  const auto order = static_cast<std::memory_order>(step.order);
  switch (step.kind) {
    case irt::fuzz::load:
      return v.load(order);
    case irt::fuzz::store:
      v.store(step.value, order);
      return 0;
    case irt::fuzz::exchange:
      return v.exchange(step.value, order);
    case irt::fuzz::add:
      return v.fetch_add(step.value, order);
    case irt::fuzz::fence:
      std::atomic_thread_fence(order);
      return 0;
    case irt::fuzz::compare: {
      int expected = 0;
      v.compare_exchange_strong(expected, step.value, order, std::memory_order_relaxed);
      return expected;
    }
  }
  return 0;
}

}  // namespace

extern "C" void irt_fuzz_run(const Step* steps, unsigned count, unsigned thread) {
  for (unsigned i = 0; i < count; ++i) seen[thread][i] = run(steps[i]);
}
