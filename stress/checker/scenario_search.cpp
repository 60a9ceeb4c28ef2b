#include "stress/checker/scenario_search.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <span>
#include <vector>

#include "stress/checker/deadline.hpp"
#include "stress/checker/report.hpp"
#include "stress/checker/result_bytes.hpp"
#include "stress/checker/scenario_client.hpp"
#include "stress/checker/shape_search.hpp"
#include "stress/checker/worker_pool.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::checker {

namespace {

constexpr std::uint64_t executions_per_round = 500;

Search search_of(const CheckSettings& settings, std::uint64_t seed) {
  constexpr std::array<Search, 3> all{Search::pos, Search::pct, Search::random};
  return settings.search.value_or(all.at(seed % all.size()));
}

/// The rounds of one scenario.
class Rounds {
 public:
  Rounds(const QueueEntry& entry, virtual_cores::Module& module, const stress::Scenario& scenario,
         const CheckSettings& settings)
      : entry_(entry), module_(module), scenario_(scenario), settings_(as_seen(settings, module)) {}

  [[nodiscard]] std::uint64_t seed(std::uint64_t round) const {
    return settings_.options.seed + round;
  }

  /// At most `seconds`.
  [[nodiscard]] Result make(std::uint64_t round, double seconds) const {
    const ScenarioClient client = client_of(round);
    return check(client.program(), options_of(round, seconds));
  }

  [[nodiscard]] std::string report(std::uint64_t round, const Result& result,
                                   const std::string& command) const {
    ScenarioClient client = client_of(round);
    const Options options = options_of(round, 1e9);
    const Result simple = simplest(client.program(), options, result);
    const std::string schedule = to_string(simple.schedule);
    return fmt::format("{}\nreplay: {} --seed {} --replay \"{}\"\n",
                       picture_of(client, options, simple, ""), command, seed(round), schedule);
  }

  /// Empty if `result` does not come out as before.
  [[nodiscard]] std::string picture_of(const ScenarioClient& client, const Options& options,
                                       const Result& result, const std::string& dot_file) const {
    const auto execution = repeat(client.program(), options, result.schedule);
    if (execution == nullptr) return "";
    Symbols symbols(module_);
    if (!dot_file.empty()) std::ofstream(dot_file) << dot(*execution, symbols);
    return heading(*execution->finding(), symbols) +
           fmt::format(
               "scenario {}, {}. Element W:N, the N-th of worker W, is the word W * 2^{} + N.\n\n",
               scenario_.name, client.description(), stress::sequence_bits) +
           picture(*execution, client.operations(), symbols);
  }

  [[nodiscard]] ScenarioClient client_of(std::uint64_t round) const {
    return {entry_, scenario_, seed(round), settings_.capacity, settings_.real_time, &module_};
  }
  [[nodiscard]] Options options_of(std::uint64_t round, double seconds) const {
    Options options = settings_.options;
    options.search = search_of(settings_, seed(round));
    options.seed = seed(round);
    options.executions = std::min(options.executions, executions_per_round);
    options.seconds = seconds;
    return options;
  }

 private:
  const QueueEntry& entry_;
  virtual_cores::Module& module_;
  const stress::Scenario& scenario_;
  const CheckSettings settings_;
};

void add(Result& sum, Result part) {
  add_counts(sum, part);
  if (sum.incomplete.empty()) sum.incomplete = std::move(part.incomplete);
  sum.finding = std::move(part.finding);
  sum.schedule = std::move(part.schedule);
}

}  // namespace

const stress::Scenario& scenario_at(const std::string& name, const QueueEntry& entry) {
  std::vector<std::string_view> names;
  for (const auto kind : {stress::scenarios(), stress::contention_scenarios()})
    for (const stress::Scenario& scenario : kind) {
      if (scenario.generations != 1 || !stress::allows(entry.methods, entry.claims, scenario))
        continue;
      if (scenario.name == name) return scenario;
      names.push_back(scenario.name);
    }
  const stress::Scenario* const other = stress::find_scenario(name);
  throw UsageError(
      fmt::format("--scenario {}: {}; there are {}", name,
                  other == nullptr ? "no such scenario"
                  : other->generations != 1
                      ? "its workers are several threads each, one after the other, and on "
                        "virtual cores each is one"
                      : "it calls methods that this queue does not have, or is for more workers",
                  fmt::join(names, ", ")));
}

ShapeResult sample_scenario(const QueueEntry& entry, virtual_cores::Module& module,
                            const stress::Scenario& scenario, const CheckSettings& settings,
                            const std::string& command) {
  const Rounds rounds(entry, module, scenario, settings);
  const Deadline deadline(settings.seconds);
  ShapeResult all{.shape = std::string(scenario.name), .search = "samples"};
  const std::unique_ptr<WorkerPool> pool =
      settings.jobs <= 1
          ? nullptr
          : std::make_unique<WorkerPool>(settings.jobs, settings.seconds + 120,
                                         [&](std::uint64_t round) -> std::optional<std::string> {
                                           if (deadline.passed()) return std::nullopt;
                                           return to_bytes(rounds.make(round, deadline.left()));
                                         });
  for (std::uint64_t round = 0;; ++round) {
    Result part;
    if (pool != nullptr) {
      const std::optional<std::string> told = pool->next();
      if (!told) break;
      part = from_bytes(*told);
    } else {
      if (deadline.passed()) break;
      part = rounds.make(round, deadline.left());
    }
    add(all.result, std::move(part));
    if (!all.result.finding) continue;
    if (settings.reports) all.report = rounds.report(round, all.result, command);
    break;
  }
  return all;
}

std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const stress::Scenario& scenario, const CheckSettings& settings,
                   const std::string& schedule, const std::string& dot_file) {
  const Rounds rounds(entry, module, scenario, settings);
  Result result;
  result.schedule = parse_schedule(schedule);
  return rounds.picture_of(rounds.client_of(0), rounds.options_of(0, 1e9), result, dot_file);
}

}  // namespace irt::checker
