/// `irt simulate`: how a queue behaves on machines that are not there.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>

#include "bench/many_core/renderer/sweep.hpp"
#include "bench/many_core/sweeps/sensitivity.hpp"
#include "bench/many_core/sweeps/sweep.hpp"
#include "bench/many_core/sweeps/validation.hpp"
#include "bench/running/interrupt.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace irt::many_core {
namespace {

struct Arguments {
  SweepOptions sweep;
  std::string cores = "1..128", placement = "close", scenario = "pairs";
  std::vector<std::string> plugins;
  double milliseconds = 1;
  bool validate = false, sensitivity = false, list = false;
};

int list(const virtual_cores::QueueModules& queues) {
  fmt::print("machines (bench/many_core/profiles)\n");
  for (const Profile& profile : profiles())
    fmt::print("  {:<22} {:>4} threads  {}\n", profile.name, profile.threads(), profile.summary);
  fmt::print("queues\n");
  for (const std::string& name : queues.names()) fmt::print("  {}\n", name);
  fmt::print("scenarios\n");
  for (const contention::Scenario& each : contention::scenario_table)
    fmt::print("  {:<22} {}\n", each.name, each.operation_mix);
  fmt::print("primitives\n");
  for (const auto& [name, summary] : primitives()) fmt::print("  {:<22} {}\n", name, summary);
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Predicts how queues behave on many cores, by running their unmodified code on virtual cores "
      "under a cache-coherence cost model. Every figure is simulated.",
      "irt simulate");
  app.footer("--renderer replays the ray tracer instead: irt simulate --renderer --help");
  Arguments arguments;
  SweepOptions& sweep = arguments.sweep;
  const CLI::Option* const machine =
      app.add_option("--machine", sweep.machines,
                     "machine profiles, or files (default: granite-rapids-96; to validate: this "
                     "machine's own)")
          ->delimiter(',');
  app.add_option("--queue,--queues", sweep.subjects, "queues (default: all)")->delimiter(',');
  app.add_option("--plugin", arguments.plugins,
                 "shared objects that irt_add_plugin() built, with further queues");
  app.add_option("--primitive", sweep.primitives, "what cores compete for, instead of queues")
      ->delimiter(',');
  app.add_option("--cores,--threads", arguments.cores,
                 "threads: 1..128 (in steps of about a half), or a list as 1,2,4")
      ->capture_default_str();
  app.add_option("--scenario", arguments.scenario, "who pushes and pops what (see --list)")
      ->capture_default_str();
  app.add_option("--work", sweep.work_ns, "work between operations, ns")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--capacity", sweep.capacity, "of bounded queues, elements")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 26));
  app.add_option("--placement", arguments.placement,
                 "close (a core each), siblings (both threads of a core) or spread (over sockets)")
      ->capture_default_str();
  app.add_option("--time", arguments.milliseconds, "simulated milliseconds that are counted")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 1000.0));
  app.add_option("--seeds", sweep.seeds, "runs of each point")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--seed", sweep.first_seed, "of the first run")->capture_default_str();
  app.add_option("--timeout", sweep.timeout_s, "seconds after which a run is given up")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--jobs", sweep.jobs, "processes at once (default: the host's cores)");
  app.add_option("--out", sweep.out, "directory of the results")->capture_default_str();
  app.add_option("--json", sweep.json, "write the figures here, too");
  app.add_flag("--resume", sweep.resume, "keep what the last sweep has simulated already");
  app.add_flag("--validate", arguments.validate,
               "compare with this machine and with published measurements");
  app.add_flag("--sensitivity", arguments.sensitivity,
               "say which conclusions hold over the ranges of the machine's figures");
  app.add_flag("--list", arguments.list, "list machines, queues, scenarios and primitives");
  tell_in_one_line(app, "irt simulate");
  if (const auto code = parse(app, argc, argv)) return *code;
  for (const std::string& plugin : arguments.plugins) sweep.queues.add(plugin);
  if (arguments.list) return list(sweep.queues);
  const bool all = arguments.validate || (sweep.subjects.empty() && sweep.primitives.empty());
  sweep.queues.prepare(all ? sweep.queues.names() : sweep.subjects);
  sweep.cores = parse_cores(arguments.cores);
  sweep.scenario = parse_scenario(arguments.scenario);
  sweep.placement = parse_placement(arguments.placement);
  sweep.measured_ns = arguments.milliseconds * 1e6;
  if (arguments.validate) {
    if (machine->count() == 0) sweep.machines.clear();
    return validate(sweep, watch_for_interrupt());
  }
  if (arguments.sensitivity) return sensitivity(sweep, watch_for_interrupt());
  return simulate_sweep(sweep, watch_for_interrupt());
}

}  // namespace
}  // namespace irt::many_core

int main(int argc, char** argv) {
  return irt::run_program("irt simulate", [&] {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    return std::ranges::find(arguments, "--renderer") != arguments.end()
               ? irt::many_core::simulate_renderer(arguments)
               : irt::many_core::run(argc, argv);
  });
}
