/// `irt bench contention` and `irt bench compare`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <string_view>

#include "bench/contention/child.hpp"
#include "bench/contention/compare.hpp"
#include "bench/contention/counting.hpp"
#include "bench/contention/subjects.hpp"
#include "bench/contention/sweep.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"
#include "stress/running/shard.hpp"

namespace irt::contention {
namespace {

// The fields of the plan that were set.
std::vector<std::string> given(const CLI::App& command) {
  constexpr std::array<std::pair<const char*, const char*>, 5> other_names{{
      {"queue", "queues"},
      {"scenario", "scenarios"},
      {"placement", "placements"},
      {"capacity", "capacities"},
      {"plugin", ""},
  }};
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    std::string name = option->get_single_name();
    std::ranges::replace(name, '-', '_');
    for (const auto& [long_name, field] : other_names) {
      if (name == long_name) name = field;
    }
    if (nlohmann::json(Plan()).contains(name)) names.push_back(name);
    if (name == "shard") names.emplace_back("shards");
  }
  return names;
}

// A real number; not "nan", which no comparison refuses.
CLI::Validator real(double low, double high) {
  return {[=](std::string& text) {
            double value = 0;
            const bool good =
                CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
            return good ? std::string() : fmt::format("{}: must be from {} to {}", text, low, high);
          },
          fmt::format("from {} to {}", low, high)};
}

int list() {
  fmt::print("scenarios (--scenario)\n");
  for (const Scenario& one : scenarios()) fmt::print("  {:<20} {}\n", one.name, one.operation_mix);
  fmt::print("  {:<20} N producers, M consumers, as 3x1\n\nplacements (--placement)\n", "NxM");
  for (const Policy& one : policies()) fmt::print("  {:<20} {}\n", one.name, one.summary);
  return 0;
}

struct Tool {
  QueueRegistry queues;
  SweepOptions sweeping;
  CompareOptions comparing;
  bool list = false;
  int code = 0;

  void add_sweep(CLI::App& app);
  void add_compare(CLI::App& app);
};

void Tool::add_sweep(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("contention", "time queues under contention, in pinned sweeps");
  Plan& plan = sweeping.plan;
  const auto list_of = [&](const char* name, auto& values, const char* description) {
    return command.add_option(name, values, description)->delimiter(',');
  };
  list_of("--queue,--queues", plan.queues, "work queues, or 'baselines' (default: all)");
  list_of("--scenario,--scenarios", plan.scenarios, "who pushes and pops what (see --list), or NxM")
      ->capture_default_str();
  list_of("--threads", plan.threads, "as 1,2,4 (default: up to twice the processors)")
      ->check(CLI::Range(1U, most_threads));
  list_of("--work", plan.work, "nanoseconds of work between operations")
      ->check(real(0.0, 1e7))
      ->capture_default_str();
  command.add_option("--work-spread", plan.work_spread, "share of it that is random, 0 to 1")
      ->check(real(0.0, 1.0))
      ->capture_default_str();
  list_of("--placement,--placements", plan.placements, "which processors (see --list)")
      ->capture_default_str();
  list_of("--capacity", plan.capacities, "elements a bounded queue holds; producers wait beyond it")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 30))
      ->capture_default_str();
  command
      .add_option("--repetitions", plan.repetitions,
                  "rounds over everything, each in processes of its own")
      ->check(CLI::Range(1U, 10'000U))
      ->capture_default_str();
  command.add_option("--seconds", plan.seconds, "the timed interval of a repetition")
      ->check(real(0.001, 3600.0))
      ->capture_default_str();
  command.add_option("--warmup", plan.warmup, "seconds a warm-up takes at most")
      ->check(real(0.0, 3600.0))
      ->capture_default_str();
  command.add_option("--patience", plan.patience, "seconds until a queue counts as hung")
      ->check(real(0.1, 3600.0))
      ->capture_default_str();
  command.add_flag("--latency", plan.latency, "percentiles, too, in repetitions of their own");
  command.add_flag("--order", plan.order,
                   "rank error and overtaking, too, in repetitions of their own that write every "
                   "operation down; of scenarios with one queue");
  command.add_option("--seed", plan.seed, "of everything random")->capture_default_str();
  command.add_option_function<std::string>(
      "--shard",
      [&plan](const std::string& text) {
        const Shard part = parse_shard(text);
        plan.shard = part.index;
        plan.shards = part.count;
      },
      "i/n: the i-th of n parts of the sweep, from 0");
  command
      .add_option_function<std::vector<std::string>>(
          "--plugin",
          [this](const std::vector<std::string>& files) {
            for (const std::string& file : files) {
              queues.open(file);
              sweeping.plan.plugins.push_back(std::filesystem::absolute(file).string());
            }
          },
          "shared object with a queue, NAME.so; by its concrete type where NAME.contention.so is "
          "beside it")
      ->trigger_on_parse();
  command.add_option("--out", sweeping.out, "directory of the results")->capture_default_str();
  command.add_option("--json", sweeping.json, "write the figures here, too");
  command.add_flag("--resume", sweeping.resume, "go on where the last sweep was stopped");
  command.add_flag("--list", list, "scenarios and placements");
  command.final_callback([this, &command] {
    sweeping.given = given(command);
    code = list ? contention::list() : sweep(sweeping, queues, "/proc/self/exe");
  });
}

void Tool::add_compare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("compare", "is one result faster than the other?");
  command.add_option("files", comparing.files, "contention.json before and after; or one")
      ->required()
      ->expected(1, 2);
  command
      .add_option("--queues", comparing.queues,
                  "two: runs of the first queue against runs of the second")
      ->delimiter(',');
  command.add_flag("--per-cpu-second", comparing.per_cpu_second,
                   "per second of processor time, which other programs take nothing of");
  command.add_option("--json", comparing.json, "write the comparisons as JSON");
  command.final_callback([this] { code = compare(comparing); });
}

int run(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == child_command) return run_as_child();
  CLI::App app("Work queues under contention.", "irt bench");
  app.require_subcommand(1);
  Tool tool;
  tool.add_sweep(app);
  tool.add_compare(app);
  tell_in_one_line(app, "irt bench");
  if (const auto code = parse(app, argc, argv)) return *code;
  return tool.code;
}

}  // namespace
}  // namespace irt::contention

int main(int argc, char** argv) {
  return irt::run_program(
      "irt bench", [&] { return irt::contention::run(argc, argv); },
      "fewer threads or a smaller capacity");
}
