// `irt bench counted`: how often queues' compare-and-swaps fail, and what else they do to shared
// memory, for each operation.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/conditions/conditions.hpp"
#include "bench/counted/counted_queue.hpp"
#include "bench/counted/pairs.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/averages.hpp"
#include "queues/nearest.hpp"
#include "queues/registry.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace irt {
namespace {

using nlohmann::json;

struct Options {
  std::vector<std::string> queues;
  std::vector<std::string> plugins;
  std::vector<unsigned> threads;
  PairsOptions pairs;
  std::string json_file;
};

/// Throws RegistryError for a queue that does not exist or was not built to count.
void check_names(const QueueRegistry& registry, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    registry.at_or_counter(name);
    if (!registry.has(name, ModuleKind::counted))
      throw RegistryError(fmt::format(
          "queue '{}' cannot be counted: its atomic operations are compiled code or inline "
          "assembly; choose among {}",
          name, fmt::join(registry.names(ModuleKind::counted), ", ")));
  }
}

json run_object(const QueueEntry& queue, const PairsOptions& options, const CountedPairs& pairs,
                const json& conditions) {
  const auto per_operation = [&](std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(pairs.operations);
  };
  return {{"kind", "counted"},
          {"source", "measured"},
          {"queue", queue.name},
          {"scenario", "pairs"},
          {"threads", options.threads},
          {"repetitions", options.rounds},
          {"status", "ok"},
          {"operations_per_second", statistics::median(pairs.counted_per_second)},
          {"samples", pairs.counted_per_second},
          {"plain_operations_per_second", statistics::median(pairs.plain_per_second)},
          {"plain_samples", pairs.plain_per_second},
          {"retries_per_operation", per_operation(pairs.events.failed_compare_exchanges)},
          {"compare_exchanges_per_operation", per_operation(pairs.events.compare_exchanges)},
          {"other_modifications_per_operation", per_operation(pairs.events.other_modifications)},
          {"atomic_loads_per_operation", per_operation(pairs.events.loads)},
          {"atomic_stores_per_operation", per_operation(pairs.events.stores)},
          {"failed_operations_per_operation", per_operation(pairs.failed)},
          {"conditions", conditions}};
}

void print(std::FILE* out, const json& run) {
  const auto number = [&run](const char* key) { return run.at(key).get<double>(); };
  fmt::print(out, "{:<24}{:>8}{:>10.4f}{:>8.3f}{:>8.3f}{:>8.3f}{:>8.3f}{:>13.2f}{:>10.2f}\n",
             run.at("queue").get<std::string>(), run.at("threads").get<unsigned>(),
             number("retries_per_operation"), number("compare_exchanges_per_operation"),
             number("other_modifications_per_operation"), number("atomic_loads_per_operation"),
             number("atomic_stores_per_operation"), number("plain_operations_per_second") / 1e6,
             number("plain_operations_per_second") / number("operations_per_second"));
}

int measure(Options options) {
  QueueRegistry registry;
  for (const std::string& plugin : options.plugins) registry.open(plugin);
  if (options.queues.empty()) options.queues = registry.names(ModuleKind::counted);
  registry.prepare(options.queues);
  registry.prepare(options.queues, ModuleKind::counted);
  check_names(registry, options.queues);
  if (options.threads.empty()) {
    options.threads = {1};
    if (std::thread::hardware_concurrency() > 1)
      options.threads.push_back(std::thread::hardware_concurrency());
  }
  if (!options.json_file.empty()) require_writable(options.json_file);
  std::FILE* const out = beside(options.json_file);
  fmt::print(out,
             "Pairs of push and pop; for each successful operation:\n{:<24}{:>8}{:>10}{:>8}{:>8}"
             "{:>8}{:>8}{:>13}{:>10}\n",
             "queue", "threads", "CAS lost", "CAS", "FAA ...", "loads", "stores", "plain Mop/s",
             "slowdown");
  json runs = json::array();
  const json now = conditions();
  for (const std::string& name : options.queues) {
    const QueueEntry& queue = registry.at_or_counter(name);
    for (const unsigned threads : options.threads) {
      options.pairs.threads = threads;
      const CountedPairs pairs = count_pairs(queue, *counted_queue(registry, name), options.pairs);
      runs.push_back(run_object(queue, options.pairs, pairs, now));
      print(out, runs.back());
      std::fflush(out);
    }
  }
  fmt::print(out,
             "slowdown: of the counting build, plain over counted, medians of {} rounds in turn.\n",
             options.pairs.rounds);
  if (!options.json_file.empty()) write_text(options.json_file, runs.dump(2) + "\n");
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Counts what queues do to shared memory: compare-and-swaps, how many of them fail, other\n"
      "read-modify-writes, atomic loads and stores. The queues are compiled once more to count\n"
      "themselves and run in turn with the plain build.",
      "irt bench counted");
  Options options;
  app.add_option("--queue,--queues", options.queues, "queues by name (default: all that count)")
      ->delimiter(',');
  app.add_option("--plugin", options.plugins,
                 "shared objects that irt_add_plugin() built, with further queues");
  app.add_option("--threads", options.threads, "numbers of threads, as 1,2,4")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
  app.add_option("--seconds", options.pairs.seconds, "of one round of one build")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str();
  app.add_option("--rounds", options.pairs.rounds, "rounds of both builds in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--json", options.json_file,
                 "write all figures to this file; - for standard output");
  if (const auto code = parse(app, argc, argv)) return *code;
  return measure(std::move(options));
}

}  // namespace
}  // namespace irt

int main(int argc, char** argv) {
  return irt::run_program("irt bench counted", [&] { return irt::run(argc, argv); });
}
