#include "bench/many_core/sweeps/sensitivity.hpp"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/running/interrupt.hpp"

namespace irt::many_core {

namespace {

using Json = nlohmann::ordered_json;

// Below this difference two queues are the same.
constexpr double least_gap = 1.05;

// A machine with one figure, or several that belong together, at an end of its range.
struct Variant {
  std::string name;
  Profile profile;
};

// The usual ranges, where the profile does not give one of its own:
// transfers by a quarter, the share of a transfer that overlaps, what a conflict and a read cost,
// how long an owner has a line, who may overtake, who is next, and how long waking takes.
std::vector<Variant> variants_of(const Profile& base) {
  std::vector<Variant> all{{"", base}};
  for (const double scale : {0.75, 1.25}) {
    Variant& variant = all.emplace_back(Variant{"transfer", base});
    for (double& transfer : variant.profile.transfer) transfer *= scale;
  }
  struct Range {
    const char* name;
    double Profile::*figure;
    double low, high;
  };
  for (const auto& [name, figure, low, high] :
       {Range{"overlap", &Profile::overlap, 0.1, 0.5}, Range{"conflict", &Profile::conflict, 0, 35},
        Range{"residence", &Profile::residence, 0, 20},
        Range{"read_occupancy", &Profile::read_occupancy, 5, 25},
        Range{"bypass", &Profile::bypass, 0, 8}, Range{"turns", &Profile::turns, 0, 1},
        Range{"kernel.wake_latency", &Profile::wake_latency, 2000, 6000}}) {
    const auto origin = base.origins.find(name);
    const bool given = origin != base.origins.end() && origin->second.low < origin->second.high;
    for (const double value :
         {given ? origin->second.low : low, given ? origin->second.high : high}) {
      if (value == base.*figure) continue;
      all.push_back({name, base});
      all.back().profile.*figure = value;
    }
  }
  return all;
}

std::string joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

int sensitivity(const SweepOptions& options, const std::atomic<bool>& interrupted) {
  const std::vector<std::string> queues =
      options.subjects.empty() ? options.queues.names() : options.subjects;
  if (queues.size() < 2) throw UsageError("--sensitivity compares queues: name two at least");
  std::deque<Variant> variants;
  std::vector<Task> tasks;
  for (const std::string& machine : options.machines) {
    for (Variant& each : variants_of(load_profile(machine))) {
      const Variant& variant = variants.emplace_back(std::move(each));
      for (const unsigned threads : options.cores) {
        if (threads < options.scenario->least_threads) continue;
        for (const std::string& queue : queues)
          tasks.push_back({&variant.profile,
                           with_threads({.subject = queue,
                                         .module = options.queues.at(queue),
                                         .scenario = options.scenario,
                                         .work_ns = options.work_ns,
                                         .capacity = options.capacity,
                                         .placement = options.placement,
                                         .warm_up_ns = options.measured_ns / 5,
                                         .measured_ns = options.measured_ns},
                                        threads),
                           options.seeds, options.first_seed});
      }
    }
  }
  std::vector<double> rates(tasks.size());
  std::size_t through = 0;
  const bool complete =
      simulate_all(tasks, options, {}, interrupted, [&](std::size_t i, const Json& run) {
        rates[i] = run["status"] == "ok" ? run["operations_per_second"].get<double>() : 0;
        fmt::print(stderr, "\r{} of {} points", ++through, tasks.size());
      });
  fmt::print(stderr, "\n");
  if (!complete) return exit_interrupted;

  // The tasks of a variant follow each other, in the same order for each.
  const auto rate = [&](const Variant& variant, unsigned threads, const std::string& queue) {
    for (std::size_t i = 0; i < tasks.size(); ++i)
      if (tasks[i].profile == &variant.profile && tasks[i].point.threads == threads &&
          tasks[i].point.subject == queue)
        return rates[i];
    return 0.0;
  };
  Json conclusions = Json::array();
  fmt::print(
      "simulated; each conclusion over the ranges of transfer, overlap, conflict, residence, "
      "read_occupancy, bypass, turns and wake_latency\n");
  for (const Variant& base : variants) {
    if (!base.name.empty()) continue;
    for (const unsigned threads : options.cores) {
      for (const std::string& a : queues) {
        for (const std::string& b : queues) {
          const double ours = rate(base, threads, a), theirs = rate(base, threads, b);
          if (theirs == 0 || ours < theirs || (ours == theirs && a >= b)) continue;
          std::set<std::string> reasons;
          double least = ours / theirs;
          for (const Variant& variant : variants) {
            if (variant.profile.name != base.profile.name) continue;
            const double ratio =
                rate(variant, threads, a) / std::max(rate(variant, threads, b), 1e-9);
            least = std::min(least, ratio);
            if (ratio < least_gap && !variant.name.empty()) reasons.insert(variant.name);
          }
          const std::string verdict = ours < least_gap * theirs ? "too close"
                                      : reasons.empty()         ? "holds"
                                                                : "depends on " + joined(reasons);
          fmt::print("{} {:>4} threads: {} beats {} {:.2f} times (at least {:.2f}): {}\n",
                     base.profile.name, threads, a, b, ours / theirs, least, verdict);
          conclusions.push_back({{"kind", "conclusion"},
                                 {"source", "simulated"},
                                 {"machine", base.profile.name},
                                 {"threads", threads},
                                 {"faster", a},
                                 {"slower", b},
                                 {"ratio", ours / theirs},
                                 {"least_ratio", least},
                                 {"verdict", verdict},
                                 {"seeds", options.seeds}});
        }
      }
    }
  }
  std::filesystem::create_directories(options.out);
  std::ofstream(options.out / "sensitivity.json") << conclusions.dump(1);
  fmt::print("written: {}/sensitivity.json\n", options.out.string());
  return 0;
}

}  // namespace irt::many_core
