#include "bench/many_core/sweeps/sweep.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/conditions/conditions.hpp"
#include "bench/many_core/sweeps/children.hpp"
#include "bench/many_core/sweeps/runs.hpp"
#include "bench/many_core/workloads/contended.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/journal.hpp"
#include "bench/running/text_files.hpp"
#include "queues/nearest.hpp"
#include "queues/roles.hpp"

namespace irt::many_core {

namespace {

using Json = nlohmann::ordered_json;

// More threads than this do not fit into the memory of a small host.
constexpr unsigned most_threads = 1024;

std::filesystem::path build_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path().parent_path();
}

std::filesystem::path primitives_module() {
  return build_directory() / "bench/many_core/workloads/irt_contended.so";
}

unsigned parse_count(std::string_view text, std::string_view all) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value == 0 ||
      value > most_threads)
    throw UsageError(
        fmt::format("--cores {}: \"{}\" is no count from 1 to {}; give a range as "
                    "1..128 or a list as 1,2,4",
                    all, text, most_threads));
  return value;
}

template <class T, std::size_t n>
T parse_name(std::string_view kind, std::string_view name, const std::array<T, n>& all) {
  std::vector<std::string_view> names;
  for (const T each : all) {
    if (name_of(each) == name) return each;
    names.push_back(name_of(each));
  }
  throw UsageError(unknown_name(kind, name, names));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> primitives() {
  const virtual_cores::Module module(primitives_module());
  std::vector<std::pair<std::string, std::string>> all;
  for (const Contended& each :
       all_contended(module.function<decltype(irt_contended)>("irt_contended")))
    all.emplace_back(each.name, each.summary);
  return all;
}

std::filesystem::path module_of_primitive(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& each : primitives()) known.push_back(each.first);
  if (std::ranges::find(known, name) == known.end())
    throw UsageError(
        unknown_name("primitive", name, std::vector<std::string_view>(known.begin(), known.end())));
  return primitives_module();
}

std::vector<unsigned> parse_cores(std::string_view text) {
  std::vector<unsigned> counts;
  if (const auto dots = text.find(".."); dots != std::string_view::npos) {
    const unsigned first = parse_count(text.substr(0, dots), text);
    const unsigned last = parse_count(text.substr(dots + 2), text);
    if (last < first)
      throw UsageError(fmt::format("--cores {}: the range ends before it begins", text));
    // 1, 2, 3, 4, 6, 8, 12, ...: two steps to each doubling.
    for (unsigned power = 1; power <= last; power *= 2) {
      for (const unsigned count : {power, power + power / 2})
        if (count >= first && count <= last) counts.push_back(count);
    }
    counts.push_back(first);
    counts.push_back(last);
  } else {
    for (std::size_t at = 0; at <= text.size();) {
      const std::size_t end = std::min(text.find(',', at), text.size());
      counts.push_back(parse_count(text.substr(at, end - at), text));
      at = end + 1;
    }
  }
  std::ranges::sort(counts);
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

const contention::Scenario* parse_scenario(std::string_view name) {
  if (const contention::Scenario* found = contention::find_scenario(name)) return found;
  std::vector<std::string_view> names;
  names.reserve(std::size(contention::scenario_table));
  for (const contention::Scenario& each : contention::scenario_table) names.push_back(each.name);
  throw UsageError(unknown_name("scenario", name, names));
}

Point with_threads(Point point, unsigned threads) {
  point.threads = threads;
  if (point.scenario == nullptr) return point;
  Roles roles = point.scenario->roles(threads);
  // Of an odd number of threads the one more pops here, which no figure of a machine depends on.
  if (point.scenario->roles == contention::halves)
    roles = apart(threads / 2, threads - threads / 2);
  point.threads = roles.workers;
  point.producers = roles.producers;
  return point;
}

Placement parse_placement(std::string_view name) {
  return parse_name("placement", name,
                    std::array{Placement::close, Placement::siblings, Placement::spread});
}

namespace {

// What tells one simulated run from another. The code of the queue is none of it: resume only with
// the same build.
std::string key_of(const Task& task, std::uint64_t seed) {
  const Point& p = task.point;
  return fmt::format("{} {} {} threads={} producers={} work={} capacity={} {} time={}+{} seed={}",
                     to_text(*task.profile), p.subject, scenario_of(p), p.threads, p.producers,
                     p.work_ns, p.capacity, name_of(p.placement), p.warm_up_ns, p.measured_ns,
                     seed);
}

// A line of the journal.
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct Kept {
  std::string key;
  nlohmann::json result;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Kept, key, result)
constexpr const char* journal_format = "irt-simulate 1";

nlohmann::json to_json(const ChildResult& result) {
  if (result.status == "ok") return nlohmann::json::parse(result.text);
  return {{"status", result.status},
          {"message", result.status == "failed" ? result.text + result.message : result.message}};
}

}  // namespace

bool simulate_all(std::span<const Task> tasks, const SweepOptions& options,
                  const std::filesystem::path& journal, const std::atomic<bool>& interrupted,
                  const std::function<void(std::size_t, const Json&)>& done) {
  struct Run {
    std::size_t task;
    std::uint64_t seed;
  };
  std::optional<Journal<Kept>> kept;
  std::map<std::string, nlohmann::json> known;
  if (!journal.empty()) {
    const bool go_on = options.resume && std::filesystem::exists(journal);
    kept = go_on ? Journal<Kept>::resume(journal, journal_format)
                 : Journal<Kept>::begin(journal, {{"format", journal_format}});
    for (const Kept& one : kept->results()) known[one.key] = one.result;
  }
  // By seed, whichever is done first.
  std::vector<std::map<std::uint64_t, nlohmann::json>> results(tasks.size());
  const auto add = [&](std::size_t task, std::uint64_t seed, const nlohmann::json& result) {
    results[task][seed] = result;
    if (results[task].size() != tasks[task].seeds) return;
    std::vector<nlohmann::json> in_order;
    for (const auto& [number, one] : results[task]) in_order.push_back(one);
    done(task, summarise(*tasks[task].profile, tasks[task].point, in_order));
  };
  std::vector<Run> runs;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (std::uint64_t seed = tasks[i].first_seed; seed < tasks[i].first_seed + tasks[i].seeds;
         ++seed) {
      const auto found = known.find(key_of(tasks[i], seed));
      if (found != known.end()) {
        add(i, seed, found->second);
      } else {
        runs.push_back({i, seed});
      }
    }
  }
  const unsigned jobs =
      options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
  run_in_children(
      runs.size(), jobs, options.timeout_s,
      [&](std::size_t i) {
        const Task& task = tasks[runs[i].task];
        return simulate(*task.profile, task.point, runs[i].seed, runs[i].seed == task.first_seed)
            .dump();
      },
      [&](std::size_t i, const ChildResult& child) {
        const nlohmann::json result = to_json(child);
        if (kept) kept->add({key_of(tasks[runs[i].task], runs[i].seed), result});
        add(runs[i].task, runs[i].seed, result);
      },
      interrupted);
  return !interrupted;
}

namespace {

// What the queue of a module claims and has; nothing where it does not load.
std::optional<std::pair<Claims, Methods>> queue_in(const std::filesystem::path& file) {
  try {
    const virtual_cores::Module module(file);
    const QueueEntry& entry = virtual_cores::queue_of(module);
    return std::pair(entry.claims, entry.methods);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

// Why a queue cannot be run in a scenario; empty if it can.
std::string obstacle(const Point& point) {
  if (point.scenario == nullptr || point.threads == 1) return {};
  const auto read = queue_in(point.module);
  if (!read) return {};  // to be told by each of its points
  const auto& [claims, methods] = *read;
  const std::string_view why = point.scenario->obstacle(claims, methods);
  return why.empty() ? irt::obstacle(claims, roles_of(point)) : std::string(why);
}

std::vector<Task> tasks_of(const SweepOptions& options, std::span<const Profile> profiles) {
  std::vector<std::pair<std::string, bool>> subjects;  // with whether it is a primitive
  for (const std::string& name : options.primitives) subjects.emplace_back(name, true);
  for (const std::string& name : options.subjects) subjects.emplace_back(name, false);
  if (subjects.empty())
    for (const std::string& name : options.queues.names()) subjects.emplace_back(name, false);
  std::vector<Task> tasks;
  for (const Profile& profile : profiles) {
    for (const auto& [name, primitive] : subjects) {
      Point point{.subject = name,
                  .module = primitive ? module_of_primitive(name) : options.queues.at(name),
                  .scenario = primitive ? nullptr : options.scenario,
                  .work_ns = options.work_ns,
                  .capacity = options.capacity,
                  .placement = options.placement,
                  .warm_up_ns = options.measured_ns / 5,
                  .measured_ns = options.measured_ns};
      for (const unsigned threads : options.cores) {
        if (point.scenario != nullptr && threads < point.scenario->least_threads) continue;
        point = with_threads(point, threads);
        if (point.threads != threads) continue;
        const std::string why = obstacle(point);
        if (why.empty()) {
          tasks.push_back({&profile, point, options.seeds, options.first_seed});
        } else if (&profile == profiles.data()) {
          fmt::print(stderr, "{} with {} threads is left out of {}: {}\n", name, threads,
                     scenario_of(point), why);
        }
      }
    }
  }
  if (tasks.empty()) throw UsageError("nothing to simulate: no queue fits the scenario");
  return tasks;
}

// Those of each queue at its most threads.
void print_hot_lines(std::FILE* people, const Json& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const bool last = i + 1 == runs.size() || runs[i + 1]["queue"] != runs[i]["queue"];
    const std::string text = last ? hot_lines_text(runs[i]) : "";
    if (!text.empty()) fmt::print(people, "{}\n", text);
  }
}

}  // namespace

int simulate_sweep(const SweepOptions& options, const std::atomic<bool>& interrupted) {
  std::vector<Profile> profiles;
  for (const std::string& name : options.machines) profiles.push_back(load_profile(name));
  const std::vector<Task> tasks = tasks_of(options, profiles);
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) throw UsageError(fmt::format("--out {}: {}", options.out.string(), error.message()));
  const nlohmann::json surroundings = conditions();
  std::vector<Json> runs(tasks.size());
  std::size_t through = 0;
  bool findings = false;
  const bool complete =
      simulate_all(tasks, options, options.out / "simulate.journal", interrupted,
                   [&](std::size_t i, const Json& run) {
                     runs[i] = run;
                     runs[i]["conditions"] = surroundings;
                     findings |= run["status"] != "ok";
                     fmt::print(stderr, "[{}/{}] {} {} {} threads: {}\n", ++through, tasks.size(),
                                run["machine"].get<std::string>(), run["queue"].get<std::string>(),
                                run["threads"].get<unsigned>(), run["status"].get<std::string>());
                   });
  std::FILE* const people = beside(options.json);
  Json finished = Json::array();
  for (const Json& run : runs)
    if (!run.is_null()) finished.push_back(run);
  for (const Profile& profile : profiles) {
    Json of_machine = Json::array();
    for (const Json& run : finished)
      if (run["machine"] == profile.name) of_machine.push_back(run);
    if (of_machine.empty()) continue;
    fmt::print(people, "simulated: {} ({}), {}, {} ns of work, seeds {} to {}\n", profile.name,
               profile.summary, of_machine[0]["scenario"].get<std::string>(), options.work_ns,
               options.first_seed, options.first_seed + options.seeds - 1);
    fmt::print(people, "{}within {}\n", table(of_machine),
               of_machine.back()["band"].get<std::string>());
    print_hot_lines(people, of_machine);
  }
  const std::string text = finished.dump(1);
  write_text(options.out / "simulate.json", text);
  write_text(options.out / "simulate.csv", finished.empty() ? "" : csv(finished));
  if (!options.json.empty()) write_text(options.json, text);
  fmt::print(people, "written: {0}/simulate.json, {0}/simulate.csv\n", options.out.string());
  if (!complete) return exit_interrupted;
  return findings ? 1 : 0;
}

}  // namespace irt::many_core
