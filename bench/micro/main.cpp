// `irt bench micro`: what single operations cost, on Google Benchmark. Output, names and all
// options but those of queues are Google Benchmark's own, so its compare.py reads the results; the
// conditions of the run stand in the context of its JSON.
#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/conditions/conditions.hpp"
#include "bench/micro/queue_benchmarks.hpp"
#include "bench/micro/second_thread.hpp"
#include "queues/modules.hpp"
#include "queues/nearest.hpp"
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

/// Registers the benchmarks of the micro module `file`, which stays open.
void add_module(const std::filesystem::path& file) {
  void* object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw UsageError(dlerror());
  const auto* module = static_cast<const BenchmarkModule*>(dlsym(object, "irt_micro"));
  if (module == nullptr || module->abi_version != plugin_abi_version)
    throw UsageError(
        fmt::format("{}: built for another version of irt; build it again", file.string()));
  module->add();
}

struct Arguments {
  std::vector<std::string> queues, plugins;
};

void add_queues(const Arguments& given) {
  std::vector<std::filesystem::path> modules;
  std::vector<std::string> own;
  for (const std::filesystem::path plugin : given.plugins) {
    modules.push_back(module_beside(std::filesystem::absolute(plugin), ModuleKind::micro));
    if (!std::filesystem::exists(modules.back()))
      throw UsageError(fmt::format(
          "plug-in '{}': there is no {} beside it, which irt_add_plugin() builds where Google "
          "Benchmark is installed; configure and build the plug-in again",
          plugin.string(), modules.back().filename().string()));
    own.push_back(plugin.stem());
  }
  const std::vector<std::string>& tree = registered_queues(ModuleKind::micro);
  std::vector<std::string> names = given.queues;
  if (names.empty()) names = given.plugins.empty() ? tree : own;
  build_modules(names, ModuleKind::micro);
  for (const std::string& name : names) {
    if (const auto plugin = std::ranges::find(own, name); plugin != own.end()) {
      add_module(modules[static_cast<std::size_t>(plugin - own.begin())]);
    } else if (is_registered(name, ModuleKind::micro)) {
      add_module(module_of_tree(name, ModuleKind::micro));
    } else {
      throw UsageError(
          unknown_name("queue", name, std::vector<std::string_view>(tree.begin(), tree.end())));
    }
  }
}

int run(int argc, char** argv) {
  Arguments given;
  CLI::App app("What single operations of queues cost, on Google Benchmark; its options follow.",
               "irt bench micro");
  app.add_option("-q,--queue,--queues", given.queues, "queues by name (default: all)")
      ->delimiter(',');
  app.add_option("--plugin", given.plugins,
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
  for (std::string& other : others) pointers.push_back(other.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;
  const SecondThread second_thread;
  add_context();
  add_queues(given);
  const std::size_t done = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return done == 0 ? 2 : 0;
}

}  // namespace
}  // namespace irt::micro

int main(int argc, char** argv) {
  return irt::run_program("irt bench micro", [&] { return irt::micro::run(argc, argv); });
}
