#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

#include "bench/conditions/conditions.hpp"
#include "bench/many_core/renderer/sweep.hpp"
#include "bench/many_core/renderer/validation.hpp"
#include "bench/many_core/sweeps/sweep.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/text_files.hpp"
#include "queues/registry.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::many_core {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string machine = "xeon-7400";
  std::vector<std::string> queues, plugins, scenes;
  std::vector<std::uint32_t> task_sizes{256};
  std::string cores, termination, placement = "close";
  frames::WorkloadOptions workload;
  std::vector<double> mean_task_us;
  double factor = 0, one_core_fps = 0;
  unsigned repetitions = 5, seeds = 3, frames = 1;
  bool renderer = false, validate = false;
  std::string json;
};

void add_options(CLI::App& app, Arguments& given) {
  app.add_flag("--renderer", given.renderer, "replay the renderer")->required();
  app.add_option("--machine", given.machine, "a profile, or its file")->capture_default_str();
  app.add_option("--queue,--queues", given.queues, "work queues (default: the thesis' three)")
      ->delimiter(',');
  app.add_option("--plugin", given.plugins,
                 "shared objects that irt_add_plugin() built, with further queues");
  app.add_option(
      "--cores", given.cores,
      "as 1..24 (in steps of about a half) or 1,2,4 (default: powers of two, up to all)");
  app.add_option("--placement", given.placement, "close, siblings or spread")
      ->capture_default_str();
  app.add_option("--scene", given.scenes, "scenes of 'irt list', or files")->delimiter(',');
  app.add_option("--task-size", given.task_sizes, "packets of rays per task")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--bvh", given.workload.bvh, "acceleration structure");
  app.add_option("--width", given.workload.packet_width, "rays per packet");
  app.add_option("--isa", given.workload.isa, "instruction set");
  app.add_option("--shader", given.workload.shader, "what light does");
  app.add_option("--secondary", given.workload.secondary, "how secondary rays travel");
  app.add_option("--depth", given.workload.depth, "bounces")->capture_default_str();
  app.add_option("--frame-buffer", given.workload.frame_buffer, "where contributions meet");
  app.add_option("--termination", given.workload.termination, "when a thread leaves a frame");
  app.add_option("--size", given.workload.width, "pixels on a side")
      ->capture_default_str()
      ->check(CLI::Range(1, 4096));
  auto* factor = app.add_option("--work-scale", given.factor,
                                "simulated work per recorded work (default: by the clocks)")
                     ->check(CLI::Range(1e-6, 1e6));
  auto* one = app.add_option("--one-core-fps", given.one_core_fps,
                             "scale the work so that one core's makes so many frames a second")
                  ->check(CLI::Range(1e-6, 1e6))
                  ->excludes(factor);
  app.add_option("--mean-task-us", given.mean_task_us,
                 "scale the work so that tasks take so many microseconds, on average; or a list")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 1e6))
      ->excludes(factor)
      ->excludes(one);
  app.add_option("--repetitions", given.repetitions, "recorded frames")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  app.add_option("--frames", given.frames, "simulated frames, after one that is not counted")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  app.add_option("--seeds", given.seeds, "runs per point")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  app.add_flag(
      "--validate", given.validate,
      "on this machine: render, too, and compare; --machine is the profile of 'irt calibrate'");
  app.add_option("--json", given.json, "write the runs as JSON; - for stdout");
}

// Powers of two, up to all.
std::vector<unsigned> usual_cores(const Profile& machine) {
  std::vector<unsigned> cores;
  for (unsigned n = 1; n < machine.threads(); n *= 2) cores.push_back(n);
  cores.push_back(machine.threads());
  return cores;
}

std::vector<Pace> paces(const Arguments& given) {
  if (given.factor > 0) return {{Pace::Kind::factor, given.factor}};
  if (given.one_core_fps > 0) return {{Pace::Kind::one_core, given.one_core_fps}};
  std::vector<Pace> all;
  for (const double us : given.mean_task_us) all.push_back({Pace::Kind::mean_task, us * 1e3});
  if (all.empty()) all.emplace_back();
  return all;
}

void settle(Arguments& given, const QueueRegistry& registry) {
  if (given.queues.empty()) given.queues = {"local", "lfree", "lock"};
  registry.prepare(given.queues);
  for (const std::string& queue : given.queues) {
    if (registry.at(queue).claims.carries_elements) continue;
    throw UsageError(fmt::format(
        "--queue {}: only counts elements; the renderer needs a queue that gives back its tasks",
        queue));
  }
  if (given.scenes.empty()) given.scenes.emplace_back();
  given.workload.height = given.workload.width;
  parse_placement(given.placement);
}

std::vector<std::filesystem::path> modules_of(const std::vector<std::string>& queues,
                                              const virtual_cores::QueueModules& modules) {
  modules.prepare(queues);
  std::vector<std::filesystem::path> files;
  files.reserve(queues.size());
  for (const std::string& queue : queues) files.push_back(modules.at(queue));
  return files;
}

void print(const std::vector<Json>& runs) {
  fmt::print("simulated on {}; work x {:.3g}, a task {:.3g} us on average\n",
             runs.front()["machine"].get<std::string>(), runs.front()["work_scale"].get<double>(),
             runs.front()["mean_task_us"].get<double>());
  fmt::print("{:<16}{:>6}{:>10}{:>9}{:>9}{:>10}{:>10}{:>8}{:>10}\n", "queue", "cores", "FPS",
             "speed-up", "of loop", "get us", "add us", "idle %", "barrier %");
  for (const Json& run : runs) {
    fmt::print("{:<16}{:>6}", run["queue"].get<std::string>(), run["threads"].get<unsigned>());
    if (run["status"] != "ok") {
      fmt::print("  {}: {}\n", run["status"].get<std::string>(), run["message"].get<std::string>());
      continue;
    }
    const auto number = [&run](const char* key) { return run[key].get<double>(); };
    const auto factor = [&](const char* key) {
      return run[key].is_null() ? "-" : fmt::format("{:.2f}", number(key));
    };
    fmt::print("{:>10.4g}{:>9}{:>9}{:>10.3g}{:>10.3g}{:>8.1f}{:>10.1f}\n", number("fps"),
               factor("speed_up"), factor("loop_speed_up"), 1e-3 * number("get_ns"),
               1e-3 * number("add_ns"), 100 * number("share_idle"), 100 * number("share_barrier"));
  }
}

void print_comparison(const std::vector<Json>& runs) {
  fmt::print("{:<16}{:>8}{:>14}{:>20}{:>15}{:>8}\n", "queue", "threads", "measured FPS",
             "quartiles", "predicted FPS", "ratio");
  for (const Json& run : runs) {
    fmt::print("{:<16}{:>8}{:>14.2f}{:>20}", run["queue"].get<std::string>(),
               run["threads"].get<unsigned>(), run["measured_fps"].get<double>(),
               fmt::format("{:.2f} to {:.2f}", run["measured_low"].get<double>(),
                           run["measured_high"].get<double>()));
    if (run["status"] == "ok") {
      fmt::print("{:>15.2f}{:>8.3f}\n", run["predicted_fps"].get<double>(),
                 run["ratio"].get<double>());
    } else {
      fmt::print("  {}: {}\n", run["status"].get<std::string>(), run["message"].get<std::string>());
    }
  }
}

// Simulates one workload at every pace, prints what comes out and returns it.
std::vector<Json> simulate_workload(const frames::WorkloadOptions& options,
                                    const QueueRegistry& registry, const Arguments& given,
                                    const Profile& profile, RendererSweep& sweeping,
                                    const std::atomic<bool>& cancel) {
  frames::Workload workload(options);
  const Recording recording = record(workload, given.repetitions, cancel);
  if (cancel) return {};
  const bool talks = given.json != "-";
  if (talks) {
    fmt::print("\n{}, {} packets per task: {} tasks, {} rays, {:.1f} ms of work recorded\n",
               options.scene, options.task_size, recording.tasks.size(), recording.rays(),
               recording.work_ns() * 1e-6);
  }
  sweeping.replay.frame_buffer = options.frame_buffer;
  sweeping.replay.leave_when_empty = options.termination == "leave-when-empty";
  std::vector<Json> all;
  if (given.validate) {
    constexpr unsigned rounds = 5;
    sweeping.pace = {Pace::Kind::factor, 1};
    all = validate_renderer(workload, registry, profile, recording, sweeping, rounds, cancel);
    if (talks) print_comparison(all);
    return all;
  }
  for (const Pace& pace : paces(given)) {
    sweeping.pace = pace;
    auto runs = sweep_renderer(profile, recording, sweeping, cancel, nullptr);
    for (Json& run : runs) describe(run, options, sweeping.replay.placement, recording);
    if (talks && !runs.empty()) print(runs);
    all.insert(all.end(), runs.begin(), runs.end());
  }
  return all;
}

}  // namespace

int simulate_renderer(const std::vector<std::string>& arguments) {
  Arguments given;
  CLI::App app("The renderer on machines that are not there.", "irt simulate");
  add_options(app, given);
  tell_in_one_line(app, "irt simulate");
  if (const auto code = parse(app, arguments)) return *code;
  if (app.count("--depth") != 0) require_bounces(given.workload);
  QueueRegistry registry;
  virtual_cores::QueueModules modules;
  for (const std::string& plugin : given.plugins) {
    registry.open(plugin);
    modules.add(plugin);
  }
  settle(given, registry);
  const Profile profile = load_profile(given.machine);
  if (given.validate && given.cores.empty()) given.cores = "1,2";
  if (!given.json.empty()) require_writable(given.json);
  RendererSweep sweeping{
      .queues = given.queues,
      .cores = given.cores.empty() ? usual_cores(profile) : parse_cores(given.cores),
      .modules = modules_of(given.queues, modules),
      .replay = {.replay_module = IRT_REPLAY_MODULE,
                 .frames = given.frames,
                 .placement = parse_placement(given.placement)},
      .seeds = given.seeds};
  const std::atomic<bool>& cancel = watch_for_interrupt();
  Json all = Json::array();
  for (const std::string& scene : given.scenes) {
    for (const std::uint32_t task_size : given.task_sizes) {
      frames::WorkloadOptions options = given.workload;
      options.scene = scene;
      options.task_size = task_size;
      check(options);
      for (Json& run : simulate_workload(options, registry, given, profile, sweeping, cancel)) {
        all.push_back(std::move(run));
      }
    }
  }
  const Json conditions_taken = conditions("none");
  for (Json& run : all) run["conditions"] = conditions_taken;
  if (!given.json.empty()) write_text(given.json, all.dump(2) + '\n');
  if (cancel) return exit_interrupted;
  const bool sound =
      std::ranges::all_of(all, [](const Json& run) { return run["status"] == "ok"; });
  return sound ? 0 : 1;
}

}  // namespace irt::many_core
