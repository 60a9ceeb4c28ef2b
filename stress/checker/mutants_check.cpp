#include "stress/checker/mutants_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "stress/checker/queue_check.hpp"
#include "stress/checker/verdict.hpp"

namespace irt::checker {

namespace {

/// The median time of one random search over its seeds, and how many of them found the mutant.
std::string samples(const stress::Mutant& mutant, virtual_cores::Module& module, Search search,
                    const KillSettings& settings) {
  std::vector<double> seconds;
  for (unsigned seed = 1; seed <= settings.seeds; ++seed) {
    const Trial trial =
        try_queue(mutant.queue, shapes_for(mutant, search), module, search, seed, settings.seconds);
    if (trial.found) seconds.push_back(trial.seconds);
  }
  std::ranges::sort(seconds);
  const std::string times =
      seconds.empty() ? "" : fmt::format(" {:.2f}", seconds[seconds.size() / 2]);
  return fmt::format("{}/{}{}", seconds.size(), settings.seeds, times);
}

std::string outcome(const Trial& trial) {
  if (!trial.found) return trial.finished ? "passes" : "nothing found";
  return fmt::format("{:.2f} s", trial.seconds);
}

std::string evidence(const Trial& trial) {
  return trial.found ? fmt::format("{} on {} ", name_of(*trial.found), trial.shape) : "";
}

/// The default search with each seed: a cell of the kill matrix of `irt stress --mutants`.
nlohmann::json default_search(const stress::Mutant& mutant, virtual_cores::Module& module,
                              const KillSettings& settings, const Trial& first, const Trial& twin) {
  std::vector<double> seconds;
  const auto note = [&](const Trial& trial) {
    if (trial.found) seconds.push_back(trial.seconds);
  };
  note(first);
  for (unsigned seed = 2; seed <= settings.seeds; ++seed)
    note(try_queue(mutant.queue, shapes_for(mutant, {}), module, {}, seed, settings.seconds));
  return {{"runs", settings.seeds},
          {"kills", seconds.size()},
          {"slowest", seconds.empty() ? 0 : *std::ranges::max_element(seconds)},
          {"times", seconds},
          {"claim", first.found ? name_of(*first.found) : ""},
          {"twin_accused", twin.found ? evidence(twin) : ""}};
}

}  // namespace

std::vector<stress::Mutant> mutants_of(virtual_cores::Module& module) {
  std::size_t count = 0;
  const auto* first = module.function<const stress::Mutant*(std::size_t*)>("irt_mutants")(&count);
  // Copied, for the module's own table goes when its globals are reset.
  return {first, first + count};
}

std::vector<std::string> shapes_for(const stress::Mutant& mutant, std::optional<Search> search) {
  // Large rings are tried beside the aged ones, which a search that is named leaves out.
  if (search && mutant.id == "m27") return {"F:D@256"};
  // Only one of them ends frames.
  static const std::map<std::string_view, std::vector<std::string>> special{{"m46", {"E:T|T"}}};
  const auto shapes = special.find(mutant.id);
  return shapes == special.end() ? std::vector<std::string>{} : shapes->second;
}

Trial try_queue(const QueueEntry& queue, const std::vector<std::string>& shapes,
                virtual_cores::Module& module, std::optional<Search> search, std::uint64_t seed,
                double seconds) {
  CheckSettings settings;
  settings.shapes = shapes;
  settings.search = search;
  settings.seconds = seconds;
  settings.quiet = true;
  settings.reports = false;
  settings.real_time = false;  // what mutants claim of time is for real threads to judge
  settings.options.seed = seed;
  settings.generated = 100;  // a healthy twin would use up all of its time with them
  Trial trial;
  for (const ShapeResult& shape : check_queue(queue, module, settings, "").shapes) {
    trial.seconds += shape.result.seconds;
    trial.executions += shape.result.executions;
    if (shape.origin == Origin::battery && shape.search != stalls_search)
      trial.finished = trial.finished && shape.result.finished;
    if (!shape.result.finding) continue;
    trial.found = shape.result.finding->kind;
    trial.shape = shape.shape;
  }
  return trial;
}

bool kill_matrix(virtual_cores::Module& module, const KillSettings& settings) {
  const std::vector<stress::Mutant> mutants = mutants_of(module);
  for (const std::string& id : settings.ids)
    if (std::ranges::none_of(mutants, [&](const auto& m) { return m.id == id; }))
      throw std::invalid_argument(fmt::format("--mutant \"{}\": there is none of that id", id));
  if (settings.default_only)
    fmt::print("{:<11} {:>9}  {:<14} {}\n", "mutant", "default", "twin", "found as");
  else
    fmt::print("{:<11} {:>9} {:>9} {:>9} {:>12} {:>12} {:>12}  {:<14} {}\n", "mutant", "default",
               "every", "bounded", "pos", "pct", "random", "twin", "found as");
  nlohmann::json cells;
  bool good = true;
  for (const stress::Mutant& mutant : mutants) {
    if (!settings.ids.empty() && std::ranges::find(settings.ids, mutant.id) == settings.ids.end())
      continue;
    const auto once = [&](const QueueEntry& queue, std::optional<Search> search) {
      return try_queue(queue, shapes_for(mutant, search), module, search, 1, settings.seconds);
    };
    const Trial found = once(mutant.queue, {});
    const Trial twin = once(mutant.twin, {});
    good = good && found.found && !twin.found;
    const std::string verdict = twin.found ? "ACCUSED" : outcome(twin);
    if (settings.default_only) {
      nlohmann::json cell = default_search(mutant, module, settings, found, twin);
      good = good && cell["kills"] == settings.seeds;
      fmt::print("{:<11} {:>9}  {:<14} {}\n", mutant.id, outcome(found), verdict,
                 evidence(found) + evidence(twin));
      cells[std::string(mutant.id)] = {{"checker", std::move(cell)}};
    } else {
      fmt::print("{:<11} {:>9} {:>9} {:>9} {:>12} {:>12} {:>12}  {:<14} {}\n", mutant.id,
                 outcome(found), outcome(once(mutant.queue, Search::exhaustive)),
                 outcome(once(mutant.queue, Search::bounded)),
                 samples(mutant, module, Search::pos, settings),
                 samples(mutant, module, Search::pct, settings),
                 samples(mutant, module, Search::random, settings), verdict,
                 evidence(found) + evidence(twin));
    }
    std::fflush(stdout);
  }
  if (!settings.json.empty()) {
    std::ofstream file(settings.json);
    file << cells.dump(2) << '\n';
    if (!file) throw std::runtime_error(fmt::format("cannot write \"{}\"", settings.json));
  }
  return good;
}

}  // namespace irt::checker
