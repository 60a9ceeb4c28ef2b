// `irt bench micro`: what single operations cost, on Google Benchmark. Options, output and names
// are Google Benchmark's own, so its compare.py reads the results; the conditions of the run stand
// in the context of its JSON.
#include <benchmark/benchmark.h>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/conditions/conditions.hpp"
#include "bench/micro/second_thread.hpp"
#include "stress/running/program.hpp"

namespace irt::micro {

namespace built_in {
#define IRT_QUEUE(identifier) void add_##identifier();
#include "micro_queues.inc"
#undef IRT_QUEUE
}  // namespace built_in

namespace {

void add_queues() {
#define IRT_QUEUE(identifier) built_in::add_##identifier();
#include "micro_queues.inc"
#undef IRT_QUEUE
}

void add_context() {
  const nlohmann::json all = conditions();
  for (const auto& [key, value] : all.items())
    benchmark::AddCustomContext(key, value.is_string() ? value.get<std::string>() : value.dump());
}

int run(std::vector<char*> arguments) {
  // Options that come later win.
  std::string shorter = "--benchmark_min_time=0.1";
  arguments.insert(arguments.begin() + 1, shorter.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  const SecondThread second_thread;
  add_context();
  add_queues();
  const std::size_t done = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return done == 0 ? 2 : 0;
}

}  // namespace
}  // namespace irt::micro

int main(int argc, char** argv) {
  return irt::run_program("irt", [&] { return irt::micro::run({argv, argv + argc}); });
}
