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

constexpr std::array<std::string_view, 3> instruments{"oracles", "tsan", "asan"};

std::string_view own_instrument() {
  return sanitizer == Sanitizer::none ? instruments[0] : sanitizer_name();
}

std::uint8_t bit_of(std::string_view instrument) {
  return instrument == "tsan" ? by_tsan : instrument == "asan" ? by_asan : by_oracles;
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

Result run_once(const QueueEntry& queue, const Scenario& scenario, double seconds,
                std::uint64_t seed, const ClockQuality& clock) {
  const Assignment assignment{queue, clock, seconds, seed, ""};
  Result result;
  result.queue = queue.name;
  run_in_child(
      result, seconds, 30, [&](Messenger& m) { run_scenario(assignment, scenario, m); },
      [](std::uint64_t) {});
  return result;
}

Cell examine(const Mutant& mutant, const KillOptions& options, const ClockQuality& clock) {
  Cell cell;
  const bool should_see = (mutant.seen & bit_of(own_instrument())) != 0;
  // An instrument that is not expected to see the bug looks once, for the record.
  for (unsigned run = 0; run < (should_see ? options.runs : 1); ++run) {
    const Result result =
        run_once(mutant.queue, mutant.scenario, should_see ? options.seconds : options.seconds / 5,
                 options.seed + run, clock);
    ++cell.runs;
    if (result.findings.empty()) continue;
    ++cell.kills;
    cell.times.push_back(result.findings[0].seconds);
    cell.slowest = std::max(cell.slowest, result.findings[0].seconds);
    if (cell.claim.empty()) cell.claim = result.findings[0].claim;
  }
  const Result twin =
      run_once(mutant.twin, mutant.scenario, options.seconds / 10, options.seed, clock);
  if (!twin.findings.empty()) {
    cell.twin_accused = twin.findings[0].claim + "\n" + twin.findings[0].evidence;
  }
  return cell;
}

std::string show(const Cell* cell) {
  if (cell == nullptr) return "not run";
  if (cell->kills == 0) return "-";
  std::vector<double> times = cell->times;
  std::nth_element(times.begin(), times.begin() + std::ssize(times) / 2, times.end());
  const std::string median = fmt::format("{:.2f} s", times[times.size() / 2]);
  if (cell->runs == 1) return median;
  return fmt::format("{} {}/{}", median, cell->kills, cell->runs);
}

void print_row(const Mutant& mutant, const Row& row) {
  fmt::print("{:<11}", mutant.id);
  bool twin_ok = true;
  for (const std::string_view instrument : instruments) {
    const auto cell = row.find(std::string(instrument));
    fmt::print(" {:<14}", show(cell == row.end() ? nullptr : &cell->second));
    twin_ok = twin_ok && (cell == row.end() || cell->second.twin_accused.empty());
  }
  fmt::print(" {:<8} {}\n", twin_ok ? "ok" : "ACCUSED", mutant.defect);
  if (!mutant.needs.empty()) fmt::print("{:<11} needs the checker: {}\n", "", mutant.needs);
  std::fflush(stdout);
}

/// Whether an instrument that ran kept its promise on this mutant.
bool kept(const Mutant& mutant, const Row& row) {
  bool good = true;
  for (const auto& [instrument, cell] : row) {
    if ((mutant.seen & bit_of(instrument)) != 0 && cell.kills < cell.runs) {
      fmt::print("{:<11} survived {} of {} runs under {}\n", mutant.id, cell.runs - cell.kills,
                 cell.runs, instrument);
      good = false;
    }
    if (!cell.twin_accused.empty()) {
      fmt::print("{:<11} healthy twin accused under {}: {}\n", mutant.id, instrument,
                 cell.twin_accused);
      good = false;
    }
  }
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
    return options.ids.empty() ||
           std::find(options.ids.begin(), options.ids.end(), mutant.id) != options.ids.end();
  };
  for (const std::string& id : options.ids) {
    if (std::none_of(mutants().begin(), mutants().end(),
                     [&](const Mutant& m) { return m.id == id; })) {
      throw std::runtime_error(
          fmt::format("no mutant '{}'; there are m01 to m46 and the thesis' "
                      "listings thesis-7.1 and thesis-7.3",
                      id));
    }
  }
  Matrix matrix = read(options.merge);
  fmt::print(
      "time to the first report (median; kills/runs)\n{:<11} {:<14} {:<14} {:<14} {:<8} {}\n",
      "mutant", instruments[0], instruments[1], instruments[2], "twin", "defect");
  for (const Mutant& mutant : mutants()) {
    if (!chosen(mutant)) continue;
    Row& row = matrix[std::string(mutant.id)];
    row[std::string(own_instrument())] = examine(mutant, options, clock);
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
