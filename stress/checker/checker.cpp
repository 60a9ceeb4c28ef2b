#include "stress/checker/checker.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

#include "stress/checker/deadline.hpp"
#include "stress/checker/depth_first.hpp"
#include "stress/checker/dpor.hpp"
#include "stress/checker/exchange.hpp"
#include "stress/checker/random.hpp"

namespace irt::checker {

namespace {

std::unique_ptr<Strategy> make_strategy(const Options& options, unsigned budget,
                                        std::vector<unsigned> roles) {
  switch (options.search) {
    case Search::exhaustive:
      return std::make_unique<Dpor>(options.shard, options.shards, std::move(roles));
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
std::optional<bool> repeats(const Program& program, const Options& options, Deadline deadline,
                            Result& result) {
  const auto trace = [&](std::uint64_t seed) -> std::optional<std::string> {
    Execution execution(program, options.limits);
    execution.orders().weaken(options.weakened);
    execution.conclusion().until(deadline);
    for (;;) {
      RandomWalk walk(seed, 0, 1);
      walk.begin();
      const Outcome outcome = execution.run(walk);
      if (execution.conclusion().incomplete_at() != nullptr) {
        result.incomplete = execution.conclusion().incomplete();
        result.incomplete_at = execution.conclusion().incomplete_at();
        return std::nullopt;
      }
      if (execution.conclusion().out_of_time()) return std::nullopt;
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

void call_different(Result& result) {
  result.differs = true;
  result.incomplete =
      "executions differ where all choices are the same: the code depends on chance, time or a "
      "state that the checker does not give it";
}

/// Whether what else is asked for allows to exchange equal threads: whether an allocation fails, or
/// gets old memory, does not depend on its thread alone, and neither does what is read in a race;
/// and executions that end in what is known are not looked at further.
bool may_exchange(const Program& program, const Options& options) {
  const Limits& limits = options.limits;
  return options.symmetry && options.search == Search::exhaustive && limits.races &&
         !limits.reuse_memory && limits.failing_allocations == 0 && options.known.empty() &&
         (!program.judge || program.outcome);
}

/// One search, from its first execution to its last.
class Exploration {
 public:
  Exploration(const Program& program, const Options& options, Execution& execution)
      : program_(program), options_(options), execution_(execution) {}

  Result run() {
    const unsigned last_budget = options_.search == Search::bounded ? options_.budget : 0;
    for (budget_ = 0; budget_ <= last_budget; ++budget_) {
      begin_anew();
      while (strategy_->begin()) {
        if ((made_ & 63U) == 0) tell();
        if (made_ == options_.executions || result_.seconds > options_.seconds ||
            (options_.stops && options_.stops(made_)))
          return std::move(result_);
        if (!goes_on()) {
          result_.seconds = stopwatch_.seconds();
          return std::move(result_);
        }
      }
      if (strategy_->books().left_out && result_.incomplete.empty())
        result_.incomplete = "too many alternatives to keep in mind";
    }
    result_.finished = result_.incomplete.empty();
    result_.explored = result_.finished ? 1 : result_.explored;
    result_.seconds = stopwatch_.seconds();
    return std::move(result_);
  }

  /// What only all executions together show.
  void note_leaks(Result& result) const {
    result.never_freed = execution_.never_freed();
    if (result.finding) return;
    auto late = execution_.late_leak();
    if (!late) return;
    result.finished = false;
    result.finding = std::move(late->first);
    result.schedule = {std::move(late->second), strategy_->resumes_waiting()};
  }

 private:
  void begin_anew() {
    exchange_.reset();
    if (may_exchange(program_, options_) && result_.uneven.empty())
      exchange_.emplace(program_, execution_);
    if (exchange_ && exchange_->roles().empty()) exchange_.reset();
    strategy_ =
        make_strategy(options_, budget_, exchange_ ? exchange_->roles() : std::vector<unsigned>{});
  }

  void tell() {
    result_.seconds = stopwatch_.seconds();
    result_.explored = strategy_->explored();
    if (!options_.progress || result_.seconds < told_.seconds + 2) return;
    const double rate =
        static_cast<double>(made_ - told_.executions) / (result_.seconds - told_.seconds);
    told_ = {made_, result_.seconds, rate, execution_.steps().size(), result_.explored};
    options_.progress(told_);
  }

  /// Makes the next execution; false if it is the last.
  bool goes_on() {
    Outcome outcome = execution_.run(*strategy_);
    ++made_;
    note_limits();
    if (execution_.conclusion().out_of_time()) return false;
    const Books books = strategy_->books();
    if (books.differs) {
      call_different(result_);
      return false;
    }
    if (!books.elsewhere) {
      ++result_.executions;
      result_.complete += outcome == Outcome::complete ? 1 : 0;
      result_.blocked += outcome == Outcome::blocked ? 1 : 0;
      result_.cut += outcome == Outcome::cut ? 1 : 0;
    }
    if (outcome == Outcome::complete && options_.each) options_.each(execution_);
    if (exchange_ && outcome != Outcome::found && outcome != Outcome::restart) {
      outcome = exchanged(outcome);
      note_limits();
      if (execution_.conclusion().out_of_time()) return false;
    }
    if (!result_.uneven.empty() && options_.shards > 1) return false;  // all parts begin anew
    if (outcome == Outcome::found) {
      result_.finding = execution_.finding();
      result_.schedule = {execution_.steps_as_born(), strategy_->resumes_waiting()};
      return false;
    }
    if (outcome == Outcome::restart) {
      begin_anew();
      result_.complete = result_.blocked = result_.cut = 0;
    }
    return true;
  }

  void note_limits() {
    result_.threads = std::max(result_.threads, static_cast<unsigned>(execution_.born().size()));
    result_.assumed_waits = execution_.assumed_waits();
    result_.incomplete = execution_.conclusion().incomplete();
    result_.incomplete_at = execution_.conclusion().incomplete_at();
  }

  /// How an execution ended for the search, once its equal threads were exchanged.
  Outcome exchanged(Outcome outcome) {
    const Exchange::Answer answer = exchange_->check(outcome);
    result_.exchanged = {exchange_->orders(), exchange_->histories(), exchange_->executions()};
    if (answer == Exchange::Answer::found) return Outcome::found;
    if (answer == Exchange::Answer::fails) result_.uneven = exchange_->why();
    if (strategy_->books().loses_symmetry)
      result_.uneven = "a thread goes on where an equal one waits";
    if (result_.uneven.empty() && answer == Exchange::Answer::holds) return outcome;
    result_.exchanged = {};
    return Outcome::restart;
  }

  const Program& program_;
  const Options& options_;
  Execution& execution_;
  Stopwatch stopwatch_;
  unsigned budget_ = 0;
  std::optional<Exchange> exchange_;
  std::unique_ptr<Strategy> strategy_;
  std::uint64_t made_ = 0;
  SearchProgress told_;
  Result result_;
};

}  // namespace

Result check(const Program& program, const Options& options) {
  const bool systematic = options.search == Search::exhaustive || options.search == Search::bounded;
  const Deadline deadline(options.seconds);
  Result result;
  if (systematic) {
    const auto same = repeats(program, options, deadline, result);
    if (same && !*same) call_different(result);
    if (!same || !*same) return result;
  }
  {
    Execution execution(program, options.limits);
    execution.orders().weaken(options.weakened);
    execution.conclusion().know(options.known);
    execution.conclusion().until(deadline);
    if (options.watch_orders) execution.orders().watch();
    Exploration exploration(program, options, execution);
    result = exploration.run();
    exploration.note_leaks(result);
    result.order_sites = execution.orders().sites();
    result.allocates = execution.allocations().any();
  }
  if (program.histories) result.histories = program.histories();
  confirm(program, options, result);
  return result;
}

void add_counts(Result& sum, const Result& part) {
  sum.executions += part.executions;
  sum.complete += part.complete;
  sum.blocked += part.blocked;
  sum.cut += part.cut;
  sum.assumed_waits += part.assumed_waits;
  sum.threads = std::max(sum.threads, part.threads);
  sum.allocates = sum.allocates || part.allocates;
  sum.differs = sum.differs || part.differs;
}

void confirm(const Program& program, const Options& options, Result& result) {
  if (!result.finding) return;
  const auto again = repeat(program, options, result.schedule);
  if (again != nullptr && again->finding()->kind == result.finding->kind) return;
  result.finding.reset();
  call_different(result);
}

std::unique_ptr<Execution> repeat(const Program& program, const Options& options,
                                  const Schedule& schedule) {
  Limits limits = options.limits;
  limits.kept_memory_leaks = true;  // whether it is a leak was asked when it was found
  auto execution = std::make_unique<Execution>(program, limits);
  execution->orders().weaken(options.weakened);
  execution->conclusion().know(options.known);
  for (;;) {
    Replay replay(schedule);
    replay.begin();
    const Outcome outcome = execution->run(replay);
    if (outcome == Outcome::restart) continue;
    if (outcome != Outcome::found || !replay.fits()) return nullptr;
    return execution;
  }
}

OnX86 on_x86(const Program& program, const Options& options, const Finding& finding) {
  constexpr double seconds = 2;
  const Deadline deadline(seconds);
  Options search = options;
  search.limits.on_x86 = true;
  search.shard = 0;
  search.shards = 1;
  search.executions = ~std::uint64_t{0};
  search.each = nullptr;
  search.stops = nullptr;
  search.progress = nullptr;
  // What else is wrong is passed over.
  search.known.clear();
  for (const Search kind : {Search::exhaustive, Search::pos}) {
    search.search = kind;
    for (;;) {
      search.seconds = deadline.left() / (kind == Search::exhaustive ? 2 : 1);
      if (search.seconds <= 0) break;
      const Result result = check(program, search);
      if (!result.finding) {
        if (result.finished) return search.known.empty() ? OnX86::cannot : OnX86::unknown;
        break;
      }
      if (result.finding->kind == finding.kind &&
          std::ranges::is_permutation(result.finding->places, finding.places))
        return OnX86::shows;
      search.known.push_back(*result.finding);
    }
  }
  return OnX86::unknown;
}

Result simplest(const Program& program, const Options& options, const Result& result) {
  Options search = options;
  search.search = Search::bounded;
  search.budget = 3;
  search.seconds = 2;
  search.shards = 1;
  search.each = nullptr;
  Result simple = check(program, search);
  const bool same = simple.finding && simple.finding->kind == result.finding->kind;
  return same ? simple : result;
}

}  // namespace irt::checker
