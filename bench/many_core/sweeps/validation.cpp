#include "bench/many_core/sweeps/validation.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/many_core/calibration/calibrate.hpp"
#include "bench/many_core/sweeps/native.hpp"
#include "bench/many_core/sweeps/runs.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/statistics/averages.hpp"
#include "queues/registry.hpp"

namespace irt::many_core {

namespace {

using Json = nlohmann::ordered_json;

// What a published curve may be off by: as a factor, from three threads on.
double bar_of(const std::string& kind) {
  return kind == "array" || kind == "primitive" ? 1.25 : 1.5;
}

// How far apart two queues must be for their order to count.
constexpr double clear_gap = 1.5;

double factor(double a, double b) {
  return a > b ? a / b : b / a;
}

// Where the code of a published subject is; nothing where it is not built for virtual cores.
std::optional<std::filesystem::path> module_of(const SweepOptions& options,
                                               const std::string& subject, bool primitive) {
  try {
    return primitive ? module_of_primitive(subject) : options.queues.at(subject);
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

// --- This machine -------------------------------------------------------------------------------

// What the options name; else what `irt calibrate` has measured before or measures now.
Profile profile_of_this_machine(const SweepOptions& options) {
  if (!options.machines.empty()) return load_profile(options.machines[0]);
  const std::filesystem::path known = options.out / "calibrated.json";
  if (std::filesystem::exists(known)) {
    fmt::print("this machine's profile: {}; --machine names another\n", known.string());
    return load_profile(known.string());
  }
  fmt::print("this machine's profile: calibrated now; --machine names another\n");
  return calibrate("calibrated", "this run").profile;
}

bool validate_here(const SweepOptions& options, const std::atomic<bool>& interrupted) {
  const Profile profile = profile_of_this_machine(options);
  const unsigned most = std::min({2U, std::thread::hardware_concurrency(), profile.threads()});
  std::vector<Task> tasks;
  std::vector<const QueueEntry*> entries;
  for (const QueueEntry& entry : built_in_queues()) {
    const auto module = module_of(options, std::string(entry.name), false);
    if (!entry.claims.many_to_many() || !module) continue;
    for (unsigned threads = 1; threads <= most; ++threads) {
      tasks.push_back({&profile,
                       {.subject = std::string(entry.name),
                        .module = *module,
                        .scenario = parse_scenario("pairs"),
                        .threads = threads,
                        .work_ns = options.work_ns},
                       options.seeds,
                       options.first_seed});
      entries.push_back(&entry);
    }
  }
  std::vector<double> simulated(tasks.size());
  if (!simulate_all(tasks, options, {}, interrupted, [&](std::size_t i, const Json& run) {
        simulated[i] = run["status"] == "ok" ? run["operations_per_second"].get<double>() : 0;
      }))
    return false;
  fmt::print(
      "this machine, {} ns of work: measured (median of 5) and simulated as {}\n{:<24}{:>8}"
      "{:>15}{:>15}{:>8}\n",
      options.work_ns, profile.name, "queue", "threads", "measured Mops", "simulated Mops",
      "ratio");
  for (std::size_t i = 0; i < tasks.size() && !interrupted; ++i) {
    const double measured = statistics::median(
        measure_pairs(*entries[i], tasks[i].point.threads, options.work_ns, 0.1, 5));
    fmt::print("{:<24}{:>8}{:>15.2f}{:>15.2f}{:>8.2f}\n", tasks[i].point.subject,
               tasks[i].point.threads, measured / 1e6, simulated[i] / 1e6, simulated[i] / measured);
  }
  fmt::print("\n");
  return !interrupted;
}

// --- What others have measured
// --------------------------------------------------------------------

struct Published {
  Task task;
  std::string kind, measured_as, source;
  double measured = 0, simulated = 0;
};

Json read_published() {
  std::ifstream in(IRT_PUBLISHED);
  return Json::parse(in);
}

// Pairs of queues at the same point of the same source: in which order they come.
void print_rankings(const std::vector<Published>& all) {
  unsigned right = 0, wrong = 0;
  for (const Published& a : all) {
    for (const Published& b : all) {
      const bool comparable = a.source == b.source && a.task.profile == b.task.profile &&
                              a.kind != "primitive" && b.kind != "primitive" &&
                              a.task.point.threads == b.task.point.threads;
      if (!comparable || a.measured < clear_gap * b.measured || a.task.point.threads < 3) continue;
      if (a.simulated > b.simulated) {
        ++right;
      } else {
        ++wrong;
        fmt::print(
            "  {} {} threads: {} is measured {:.1f} times as fast as {}, simulated {:.2f} "
            "times\n",
            a.task.profile->name, a.task.point.threads, a.task.point.subject,
            a.measured / b.measured, b.task.point.subject, a.simulated / b.simulated);
      }
    }
  }
  fmt::print("rankings where the published gap is over {} times: {} right, {} wrong\n", clear_gap,
             right, wrong);
}

}  // namespace

int validate(const SweepOptions& options, const std::atomic<bool>& interrupted) {
  if (!validate_here(options, interrupted)) return exit_interrupted;
  std::map<std::string, Profile> machines;
  std::vector<Published> all;
  std::map<std::string, std::optional<std::filesystem::path>> modules;
  for (const Json& row : read_published()) {
    const std::string machine = row["machine"], subject = row["queue"];
    const bool primitive = row["scenario"] == "primitive";
    const contention::Scenario* scenario =
        primitive ? nullptr : parse_scenario(row["scenario"].get<std::string>());
    const auto [known, fresh] = modules.try_emplace(subject);
    if (fresh) {
      known->second = module_of(options, subject, primitive);
      if (!known->second)
        fmt::print("{}: published, but not built for virtual cores; left out\n", subject);
    }
    if (!known->second) continue;
    if (!machines.contains(machine)) machines.emplace(machine, load_profile(machine));
    const unsigned producers = row["producers"], consumers = row["consumers"];
    const bool sides = !primitive && scenario->program == contention::Program::sides;
    Task task{&machines.at(machine),
              {.subject = subject,
               .module = *known->second,
               .scenario = scenario,
               .threads = sides ? producers + consumers : producers,
               .producers = producers,
               .work_ns = row["work_ns"],
               .capacity = row["capacity"],
               .placement = parse_placement(row["placement"].get<std::string>()),
               .warm_up_ns = options.measured_ns / 5,
               .measured_ns = options.measured_ns},
              options.seeds,
              options.first_seed};
    all.push_back({std::move(task), row["kind"], row["measured"], row["source"],
                   row["operations_per_second"], 0});
  }
  std::vector<Task> tasks;
  tasks.reserve(all.size());
  for (const Published& each : all) tasks.push_back(each.task);
  const bool complete =
      simulate_all(tasks, options, {}, interrupted, [&](std::size_t i, const Json& run) {
        all[i].simulated = run["status"] == "ok" ? run["operations_per_second"].get<double>() : 0;
      });
  std::erase_if(all, [](const Published& each) { return each.simulated == 0; });
  fmt::print(
      "published, and simulated from profiles of single costs, to which these figures were not "
      "fitted, but for LCRQ's plateau (docs/simulator.md)\n"
      "{:<20}{:<24}{:>8}{:>15}{:>15}{:>8}  {}\n",
      "machine", "queue", "threads", "measured Mops", "simulated Mops", "ratio", "measured as");
  unsigned outside = 0, judged = 0;
  double logarithms = 0;
  for (const Published& each : all) {
    const bool judges = each.task.point.threads >= 3 && each.kind != "distributed";
    const bool fits = factor(each.simulated, each.measured) <= bar_of(each.kind);
    judged += judges ? 1 : 0;
    outside += judges && !fits ? 1 : 0;
    if (judges) logarithms += std::log(factor(each.simulated, each.measured));
    fmt::print("{:<20}{:<24}{:>8}{:>15.2f}{:>15.2f}{:>8.2f}{} {}\n", each.task.profile->name,
               each.task.point.subject, each.task.point.threads, each.measured / 1e6,
               each.simulated / 1e6, each.simulated / each.measured, judges && !fits ? "!" : " ",
               each.measured_as);
  }
  fmt::print(
      "within the band (arrays and primitives 1.25 times, locks and lists 1.5 times; three "
      "threads and more): {} of {}; off by a factor of {:.2f} (geometric mean)\n",
      judged - outside, judged, judged == 0 ? 1 : std::exp(logarithms / judged));
  print_rankings(all);
  if (!complete) return exit_interrupted;
  return outside == 0 ? 0 : 1;
}

}  // namespace irt::many_core
