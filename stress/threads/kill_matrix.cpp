#include "stress/threads/kill_matrix.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "stress/threads/child.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {
namespace {

using nlohmann::json;

/// What looks at a mutant: a build and a suite.
struct Instrument {
  std::string_view name;
  Seen bit;
  Sanitizer build;
};
constexpr std::array instruments{Instrument{"oracles", by_oracles, Sanitizer::none},
                                 Instrument{"progress", by_progress, Sanitizer::none},
                                 Instrument{"tsan", by_tsan, Sanitizer::thread},
                                 Instrument{"asan", by_asan, Sanitizer::address}};

/// The column of `irt check --mutants --default-search --json`, which is merged like other builds.
/// The checker is expected to find every mutant.
constexpr std::string_view checker = "checker";

/// Whether `instrument` can be pointed at the mutant: progress is of interest where somebody claims
/// it, and its calls must not wait for elements.
bool applies(const Instrument& instrument, const Mutant& mutant) {
  if (instrument.build != sanitizer) return false;
  const Claims& claims = mutant.queue.claims;
  return instrument.bit != by_progress ||
         (mutant.scenario.drains &&
          (claims.push != Progress::blocking || claims.pop != Progress::blocking));
}

/// What one instrument did to one mutant.
struct Cell {
  unsigned runs = 0;
  unsigned kills = 0;
  double slowest = 0;             ///< seconds to the finding
  std::vector<double> times;      ///< of all kills
  std::string claim = {};         ///< of the first finding
  std::string twin_accused = {};  ///< the claim, where the twin was accused
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(Cell, runs, kills, slowest, times, claim,
                                                twin_accused)

using Row = std::map<std::string, Cell>;    // by instrument
using Matrix = std::map<std::string, Row>;  // by mutant

Result run_once(const Instrument& instrument, const QueueEntry& queue, const Scenario& scenario,
                double seconds, std::uint64_t seed, const ClockQuality& clock) {
  const Assignment assignment{queue, clock, seconds, seed, ""};
  Result result;
  result.queue = queue.name;
  const auto suite = [&](Messenger& m) {
    instrument.bit == by_progress ? run_progress(assignment, m)
                                  : run_scenario(assignment, scenario, m);
  };
  run_in_child(result, seconds, 30, suite, [](std::uint64_t) {});
  return result;
}

Cell examine(const Instrument& instrument, const Mutant& mutant, const KillOptions& options,
             const ClockQuality& clock) {
  Cell cell;
  const bool should_see = (mutant.seen & instrument.bit) != 0;
  const double seconds = should_see ? options.seconds : options.seconds / 5;
  // An instrument that is not expected to see the bug looks once, for the record.
  for (unsigned run = 0; run < (should_see ? options.runs : 1); ++run) {
    const Result result =
        run_once(instrument, mutant.queue, mutant.scenario, seconds, options.seed + run, clock);
    ++cell.runs;
    if (result.findings.empty()) continue;
    const BrokenClaim& finding = result.findings[0];
    // A last round that took long may find something too late.
    if (should_see && finding.seconds > options.seconds) continue;
    ++cell.kills;
    cell.times.push_back(finding.seconds);
    cell.slowest = std::max(cell.slowest, finding.seconds);
    if (cell.claim.empty()) cell.claim = finding.claim;
  }
  const Result twin =
      run_once(instrument, mutant.twin, mutant.scenario, options.seconds / 10, options.seed, clock);
  if (!twin.findings.empty()) {
    cell.twin_accused = twin.findings[0].claim + "\n" + twin.findings[0].evidence;
  }
  return cell;
}

std::string show(const Cell& cell) {
  if (cell.kills == 0) return cell.runs > 1 ? fmt::format("0/{}", cell.runs) : "-";
  std::vector<double> times = cell.times;
  std::ranges::nth_element(times, times.begin() + std::ssize(times) / 2);
  std::string median = fmt::format("{:.2f}", times[times.size() / 2]);
  if (cell.runs == 1) return median;
  return fmt::format("{} {:.2f} {}/{}", median, cell.slowest, cell.kills, cell.runs);
}

void print_row(const Mutant& mutant, const Row& row) {
  fmt::print("{:<11}", mutant.id);
  bool twin_ok = true;
  for (const Instrument& instrument : instruments) {
    const auto cell = row.find(std::string(instrument.name));
    fmt::print(" {:<16}", cell == row.end() ? "" : show(cell->second));
    twin_ok = twin_ok && (cell == row.end() || cell->second.twin_accused.empty());
  }
  if (const auto cell = row.find(std::string(checker)); cell != row.end()) {
    fmt::print(" {:<16}", show(cell->second));
    twin_ok = twin_ok && cell->second.twin_accused.empty();
  } else {
    fmt::print(" {:<16}", "");
  }
  fmt::print(" {:<8} {}\n", twin_ok ? "ok" : "ACCUSED", mutant.defect);
  if (!mutant.needs.empty()) fmt::print("{:<11} needs the checker: {}\n", "", mutant.needs);
  std::fflush(stdout);
}

/// Whether every instrument that ran kept its promise on this mutant.
bool kept(const Mutant& mutant, const Row& row) {
  bool good = true;
  const auto judge = [&](std::string_view instrument, bool should_see) {
    const auto found = row.find(std::string(instrument));
    if (found == row.end()) return;
    const Cell& cell = found->second;
    if (should_see && cell.kills < cell.runs) {
      fmt::print("{:<11} survived {} of {} runs under {}\n", mutant.id, cell.runs - cell.kills,
                 cell.runs, instrument);
      good = false;
    }
    if (!cell.twin_accused.empty()) {
      fmt::print("{:<11} healthy twin accused under {}: {}\n", mutant.id, instrument,
                 cell.twin_accused);
      good = false;
    }
  };
  for (const Instrument& instrument : instruments)
    judge(instrument.name, (mutant.seen & instrument.bit) != 0);
  judge(checker, true);
  return good;
}

Matrix read(const std::vector<std::string>& files) {
  Matrix matrix;
  for (const std::string& name : files) {
    std::ifstream file(name);
    if (!file) throw std::runtime_error(fmt::format("cannot read '{}'", name));
    for (const auto& [id, row] : json::parse(file).get<Matrix>()) {
      for (const auto& [instrument, cell] : row) matrix[id][instrument] = cell;
    }
  }
  return matrix;
}

}  // namespace

bool kill_mutants(const KillOptions& options, const ClockQuality& clock) {
  const auto chosen = [&](const Mutant& mutant) {
    return options.ids.empty() || std::ranges::find(options.ids, mutant.id) != options.ids.end();
  };
  Matrix matrix = read(options.merge);
  fmt::print(
      "seconds to the first report: median, slowest, kills/runs; once for the record\n{:<11}",
      "mutant");
  for (const Instrument& instrument : instruments) fmt::print(" {:<16}", instrument.name);
  fmt::print(" {:<16} {:<8} {}\n", checker, "twin", "defect");
  for (const Mutant& mutant : mutants()) {
    if (!chosen(mutant)) continue;
    Row& row = matrix[std::string(mutant.id)];
    for (const Instrument& instrument : instruments) {
      if (!applies(instrument, mutant)) continue;
      row[std::string(instrument.name)] = examine(instrument, mutant, options, clock);
    }
    print_row(mutant, row);
  }
  bool good = true;
  for (const Mutant& mutant : mutants()) {
    if (chosen(mutant)) good = kept(mutant, matrix[std::string(mutant.id)]) && good;
  }
  if (!options.json.empty()) {
    std::ofstream file(options.json);
    file << json(matrix).dump(2) << "\n";
    if (!file) throw std::runtime_error(fmt::format("cannot write '{}'", options.json));
  }
  return good;
}

}  // namespace irt::stress
