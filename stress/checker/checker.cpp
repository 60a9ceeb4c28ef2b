#include "stress/checker/checker.hpp"

#include <chrono>
#include <fmt/format.h>
#include <memory>

#include "stress/checker/depth_first.hpp"
#include "stress/checker/exchange.hpp"
#include "stress/checker/exhaustive.hpp"
#include "stress/checker/random.hpp"

namespace irt::checker {

namespace {

std::unique_ptr<Strategy> make_strategy(const Options& options, unsigned budget,
                                        std::vector<unsigned> roles) {
  switch (options.search) {
    case Search::exhaustive:
      return std::make_unique<Exhaustive>(options.shard, options.shards, std::move(roles));
    case Search::bounded:
      return std::make_unique<DepthFirst>(budget);
    case Search::random:
      return std::make_unique<RandomWalk>(options.seed, options.shard, options.shards);
    case Search::pct:
      return std::make_unique<PriorityChanges>(options.seed, options.shard, options.shards,
                                               options.depth);
    case Search::pos:
      return std::make_unique<OrderSampling>(options.seed, options.shard, options.shards);
  }
  return nullptr;
}

/// What the threads did, as one text.
std::string trace_of(const Execution& execution) {
  std::string text;
  for (const Step& step : execution.steps())
    text += fmt::format("{} {} {} ", step.thread, step.kind, step.choice);
  const Graph& graph = execution.graph();
  for (unsigned thread = 0; thread <= execution.threads(); ++thread)
    for (const EventId id : graph.thread(thread).events) {
      const Event& event = graph.event(id);
      text += fmt::format("{} {} {} ", fmt::ptr(event.pc), static_cast<std::uint64_t>(event.read),
                          static_cast<std::uint64_t>(event.written));
    }
  return text;
}

/// Whether the same choices lead to the same execution, in a few samples; none if there was no time
/// for that by `deadline`, and why, if anything but the deadline is to blame, is in `result`.
std::optional<bool> repeats(const Scenario& scenario, const Options& options, Deadline deadline,
                            Result& result) {
  const auto trace = [&](std::uint64_t seed) -> std::optional<std::string> {
    Execution execution(scenario, options.limits);
    execution.weaken(options.weakened);
    execution.until(deadline);
    for (;;) {
      RandomWalk walk(seed, 0, 1);
      walk.begin();
      const Outcome outcome = execution.run(walk);
      if (execution.incomplete_at() != nullptr) {
        result.incomplete = execution.incomplete();
        result.incomplete_at = execution.incomplete_at();
        return std::nullopt;
      }
      if (execution.out_of_time()) return std::nullopt;
      if (outcome != Outcome::restart) return trace_of(execution);
    }
  };
  const Deadline enough(0.1);  // for executions that take long
  for (std::uint64_t seed = 1; seed <= 3 && (seed == 1 || !enough.passed()); ++seed) {
    const auto first = trace(seed);
    const auto second = trace(seed);
    if (!first || !second) return std::nullopt;
    if (*first != *second) return false;
  }
  return true;
}

constexpr const char* executions_differ =
    "executions differ where all choices are the same: the code depends on chance, time or a state "
    "that the checker does not give it";

/// Whether what else is asked for allows to exchange equal threads: whether an allocation fails, or
/// gets old memory, does not depend on its thread alone, and neither does what is read in a race;
/// and executions that end in what is known are not looked at further.
bool may_exchange(const Scenario& scenario, const Options& options) {
  const Limits& limits = options.limits;
  return options.symmetry && options.search == Search::exhaustive && limits.races &&
         !limits.reuse_memory && limits.failing_allocations == 0 && options.known.empty() &&
         (!scenario.judge || scenario.outcome);
}

/// How an execution ended for the search, once its equal threads were exchanged.
Outcome exchanged(Exchange& exchange, const Strategy& strategy, Outcome outcome, Result& result) {
  Exchange::Answer answer = exchange.check(outcome);
  result.exchanged = {exchange.orders(), exchange.histories(), exchange.executions()};
  if (answer == Exchange::Answer::found) return Outcome::found;
  if (answer == Exchange::Answer::fails) result.uneven = exchange.why();
  if (strategy.loses_symmetry()) result.uneven = "a thread goes on where an equal one waits";
  if (result.uneven.empty() && answer == Exchange::Answer::holds) return outcome;
  result.exchanged = {};
  return Outcome::restart;
}

Result explore(const Scenario& scenario, const Options& options, Execution& execution) {
  using Stopwatch = std::chrono::steady_clock;
  const auto start = Stopwatch::now();
  const auto elapsed = [start] {
    return std::chrono::duration<double>(Stopwatch::now() - start).count();
  };
  Result result;
  std::uint64_t made = 0;
  SearchProgress last;
  const unsigned last_budget = options.search == Search::bounded ? options.budget : 0;
  for (unsigned budget = 0; budget <= last_budget; ++budget) {
    std::optional<Exchange> exchange;
    const auto anew = [&] {
      const bool exchanges = may_exchange(scenario, options) && result.uneven.empty();
      exchange.reset();
      if (exchanges) exchange.emplace(scenario, execution);
      if (exchange && exchange->roles().empty()) exchange.reset();
      return make_strategy(options, budget, exchange ? exchange->roles() : std::vector<unsigned>{});
    };
    auto strategy = anew();
    while (strategy->begin()) {
      if ((made & 63U) == 0) {
        result.seconds = elapsed();
        result.explored = strategy->explored();
        if (options.progress && result.seconds >= last.seconds + 2) {
          const double rate =
              static_cast<double>(made - last.executions) / (result.seconds - last.seconds);
          last = {made, result.seconds, rate, execution.steps().size(), result.explored};
          options.progress(last);
        }
      }
      if (made == options.executions || result.seconds > options.seconds ||
          (options.stops && options.stops(made)))
        return result;
      Outcome outcome = execution.run(*strategy);
      ++made;
      if (execution.out_of_time()) {
        result.incomplete = execution.incomplete();
        result.incomplete_at = execution.incomplete_at();
        result.seconds = elapsed();
        return result;
      }
      if (strategy->differs()) {
        result.incomplete = executions_differ;
        result.seconds = elapsed();
        return result;
      }
      if (!strategy->counted_elsewhere()) {
        ++result.executions;
        result.complete += outcome == Outcome::complete ? 1 : 0;
        result.blocked += outcome == Outcome::blocked ? 1 : 0;
        result.cut += outcome == Outcome::cut ? 1 : 0;
      }
      if (outcome == Outcome::complete && options.each) options.each(execution);
      if (exchange && outcome != Outcome::found && outcome != Outcome::restart)
        outcome = exchanged(*exchange, *strategy, outcome, result);
      result.assumed_waits = execution.assumed_waits();
      result.incomplete = execution.incomplete();
      result.incomplete_at = execution.incomplete_at();
      if (execution.out_of_time()) {
        result.seconds = elapsed();
        return result;
      }
      if (!result.uneven.empty() && options.shards > 1) return result;  // all parts begin anew
      if (outcome == Outcome::found) {
        result.finding = execution.finding();
        result.schedule = {execution.steps(), strategy->resumes_waiting()};
        result.seconds = elapsed();
        return result;
      }
      if (outcome == Outcome::restart) {
        strategy = anew();
        result.complete = result.blocked = result.cut = 0;
      }
    }
    if (strategy->left_out() && result.incomplete.empty())
      result.incomplete = "too many alternatives to keep in mind";
  }
  result.finished = result.incomplete.empty();
  result.explored = result.finished ? 1 : result.explored;
  result.seconds = elapsed();
  return result;
}

}  // namespace

Result check(const Scenario& scenario, const Options& options) {
  const bool systematic = options.search == Search::exhaustive || options.search == Search::bounded;
  const Deadline deadline(options.seconds);
  Result result;
  if (systematic) {
    const auto same = repeats(scenario, options, deadline, result);
    if (same && !*same) result.incomplete = executions_differ;
    if (!same || !*same) return result;
  }
  {
    Execution execution(scenario, options.limits);
    execution.weaken(options.weakened);
    execution.know(options.known);
    execution.until(deadline);
    if (options.watch_orders) execution.watch_orders();
    result = explore(scenario, options, execution);
    result.order_sites = execution.order_sites();
    result.allocates = execution.allocates();
  }
  if (scenario.histories) result.histories = scenario.histories();
  if (result.finding && repeat(scenario, options, result.schedule) == nullptr &&
      repeats(scenario, options, {}, result) == false) {
    result.finding.reset();
    result.incomplete = executions_differ;
  }
  return result;
}

std::unique_ptr<Execution> repeat(const Scenario& scenario, const Options& options,
                                  const Schedule& schedule) {
  auto execution = std::make_unique<Execution>(scenario, options.limits);
  execution->weaken(options.weakened);
  execution->know(options.known);
  for (;;) {
    Replay replay(schedule);
    replay.begin();
    const Outcome outcome = execution->run(replay);
    if (outcome == Outcome::restart) continue;
    if (outcome != Outcome::found || !replay.fits()) return nullptr;
    return execution;
  }
}

Result simplest(const Scenario& scenario, const Options& options, const Result& result) {
  Options search = options;
  search.search = Search::bounded;
  search.budget = 3;
  search.seconds = 2;
  search.shards = 1;
  search.each = nullptr;
  Result simple = check(scenario, search);
  const bool same = simple.finding && simple.finding->kind == result.finding->kind;
  return same ? simple : result;
}

}  // namespace irt::checker
