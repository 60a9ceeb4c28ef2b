/// The checker: explores what a scenario can do, and answers with a count or a counterexample.
///
///     checker::Scenario scenario{.threads = {...}, .module = &module};
///     checker::Result result = checker::check(scenario, {});
///     if (result.finding) ...
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/execution.hpp"

namespace irt::checker {

enum class Search : std::uint8_t {
  exhaustive,  ///< every graph: see exhaustive.hpp
  bounded,     ///< depth-first, budgets 0, 1, ..., `Options::budget`
  random,
  pct,
  pos,
};

struct Options {
  Search search = Search::exhaustive;
  unsigned budget = 3;  ///< deviations, for `bounded`
  unsigned depth = 3;   ///< of the bugs that `pct` looks for
  std::uint64_t seed = 1;
  std::uint64_t executions = ~std::uint64_t{0};  ///< at most
  double seconds = 1e9;                          ///< at most
  Limits limits{};
  /// Called after each execution that ran to its end.
  std::function<void(const Execution&)> each{};
};

struct Result {
  std::optional<Finding> finding;
  std::vector<Step> steps;        ///< of the execution that found it
  std::uint64_t executions = 0;   ///< of any outcome
  std::uint64_t complete = 0;     ///< ran to their end
  std::uint64_t blocked = 0;      ///< stopped at a wait that another execution ends
  std::uint64_t cut = 0;          ///< given up as inconsistent
  std::size_t assumed_waits = 0;  ///< loops taken to wait although a counter of theirs changed
  double seconds = 0;
  bool finished = false;  ///< the search came to its end: nothing is left within its bounds
};

Result check(const Scenario& scenario, const Options& options);

}  // namespace irt::checker
