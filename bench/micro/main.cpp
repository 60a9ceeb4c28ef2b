// `irt bench micro`: what single operations cost, on Google Benchmark. Output, names and all
// options but those of queues are Google Benchmark's own, so its compare.py reads the results; the
// conditions of the run stand in the context of its JSON.
#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/conditions/conditions.hpp"
#include "bench/micro/queue_benchmarks.hpp"
#include "bench/micro/second_thread.hpp"
#include "queues/registry.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::micro {
namespace {

void add_context() {
  const nlohmann::json all = conditions();
  for (const auto& [key, value] : all.items())
    benchmark::AddCustomContext(key, value.is_string() ? value.get<std::string>() : value.dump());
}

/// Registers the benchmarks of the micro module `file`.
void add_module(const std::filesystem::path& file) {
  const auto* module = static_cast<const BenchmarkModule*>(symbol_of(file, "irt_micro"));
  if (module == nullptr || module->abi_version != plugin_abi_version)
    throw UsageError(
        fmt::format("{}: built for another version of irt; build it again", file.string()));
  module->add();
}

void add_queues(std::vector<std::string> names, const std::vector<std::string>& plugins) {
  QueueRegistry queues;
  for (const std::string& plugin : plugins) queues.open(plugin);
  if (names.empty()) names = queues.names(ModuleKind::micro);
  queues.prepare(names, ModuleKind::micro);
  for (const std::string& name : names) {
    if (!queues.has(name, ModuleKind::micro)) {
      queues.at_or_counter(name);  // throws where there is no such queue
      throw UsageError(fmt::format(
          "queue '{0}': there is no {0}.micro.so beside its plug-in, which irt_add_plugin() builds "
          "where Google Benchmark is installed; configure and build it again",
          name));
    }
    add_module(queues.module(name, ModuleKind::micro));
  }
}

int run(int argc, char** argv) {
  std::vector<std::string> queues, plugins;
  CLI::App app("What single operations of queues cost, on Google Benchmark; its options follow.",
               "irt bench micro");
  app.add_option("-q,--queue,--queues", queues, "queues by name (default: all)")->delimiter(',');
  app.add_option("--plugin", plugins,
                 "shared objects that irt_add_plugin() built, with further queues");
  app.allow_extras();
  if (const auto code = parse(app, argc, argv)) {
    if (*code == 0) benchmark::PrintDefaultHelp();
    return *code;
  }
  // Options that come later win.
  std::vector<std::string> others = app.remaining();
  others.insert(others.begin(), {"irt bench micro", "--benchmark_min_time=0.1"});
  std::vector<char*> pointers;
  pointers.reserve(others.size());
  for (std::string& other : others) pointers.push_back(other.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;
  const SecondThread second_thread;
  add_context();
  add_queues(std::move(queues), plugins);
  const std::size_t done = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return done == 0 ? 2 : 0;
}

}  // namespace
}  // namespace irt::micro

int main(int argc, char** argv) {
  return irt::run_program("irt bench micro", [&] { return irt::micro::run(argc, argv); });
}
