#include "stress/checker/checker.hpp"

#include <chrono>
#include <memory>

#include "stress/checker/depth_first.hpp"
#include "stress/checker/exhaustive.hpp"
#include "stress/checker/random.hpp"

namespace irt::checker {

namespace {

std::unique_ptr<Strategy> make_strategy(const Options& options, unsigned budget) {
  switch (options.search) {
    case Search::exhaustive:
      return std::make_unique<Exhaustive>();
    case Search::bounded:
      return std::make_unique<DepthFirst>(budget);
    case Search::random:
      return std::make_unique<RandomWalk>(options.seed);
    case Search::pct:
      return std::make_unique<PriorityChanges>(options.seed, options.depth);
    case Search::pos:
      return std::make_unique<OrderSampling>(options.seed);
  }
  return nullptr;
}

}  // namespace

Result check(const Scenario& scenario, const Options& options) {
  using Stopwatch = std::chrono::steady_clock;
  const auto start = Stopwatch::now();
  const auto elapsed = [start] {
    return std::chrono::duration<double>(Stopwatch::now() - start).count();
  };
  Execution execution(scenario, options.limits);
  Result result;
  const unsigned last_budget = options.search == Search::bounded ? options.budget : 0;
  for (unsigned budget = 0; budget <= last_budget; ++budget) {
    auto strategy = make_strategy(options, budget);
    while (strategy->begin()) {
      if (result.executions == options.executions) return result;
      if ((result.executions & 63U) == 0 && (result.seconds = elapsed()) > options.seconds)
        return result;
      const Outcome outcome = execution.run(*strategy);
      ++result.executions;
      result.assumed_waits = execution.assumed_waits();
      result.complete += outcome == Outcome::complete ? 1 : 0;
      result.blocked += outcome == Outcome::blocked ? 1 : 0;
      result.cut += outcome == Outcome::cut ? 1 : 0;
      if (outcome == Outcome::complete && options.each) options.each(execution);
      if (outcome == Outcome::found) {
        result.finding = execution.finding();
        result.steps = execution.steps();
        result.seconds = elapsed();
        return result;
      }
      if (outcome == Outcome::restart) strategy = make_strategy(options, budget);
    }
  }
  result.finished = true;
  result.seconds = elapsed();
  return result;
}

}  // namespace irt::checker
