#include "tests/bench/report/synthetic.hpp"

#include <cmath>

namespace irt::synthetic {
namespace {

Json latencies(double median) {
  Json times;
  double time = median;
  for (const char* percentile : {"p50", "p90", "p99", "p99.9", "p99.99", "max"}) {
    times[percentile] = time;
    time *= 3.1;
  }
  return times;
}

}  // namespace

Json conditions(const std::string& cpu) {
  return {{"time", "2026-01-01T00:00:00Z"},
          {"cpu", cpu},
          {"packages", 1},
          {"numa_nodes", 1},
          {"cores", 32},
          {"hardware_threads", 64},
          {"hypervisor", nullptr},
          {"governor", "performance"},
          {"kernel", "6.1"},
          {"load_average", 0.1},
          {"compiler", "GNU 12.2.0"},
          {"flags", "-O2"},
          {"commit", "0123456789ab"},
          {"pinning", "one thread per core"}};
}

Json operations(const std::string& queue, unsigned threads, double per_second,
                const std::string& machine) {
  const bool simulated = !machine.empty();
  Json run{{"kind", simulated ? "simulated" : "contention"},
           {"source", simulated ? "simulated" : "measured"},
           {"queue", queue},
           {"scenario", "pairs"},
           {"producers", threads},
           {"consumers", threads},
           {"threads", threads},
           {"work_ns", 50},
           {"capacity", 65536},
           {"placement", "close"},
           {"operation_mix", "push, then pop"},
           {"repetitions", 5},
           {"status", "ok"},
           {"message", ""},
           {"operations_per_second", per_second},
           {"operations_per_second_low", per_second * 0.93},
           {"operations_per_second_high", per_second * 1.07},
           {"samples", {per_second * 0.97, per_second, per_second * 1.03}},
           {"failed_pops_per_second", per_second / 40},
           {"failed_pushes_per_second", 0},
           {"fairness", 1 / (1 + 0.02 * threads)},
           {"latency_ns", nullptr},
           {"clock_ns", 21},
           {"retries_per_operation", nullptr},
           {"context_switches_per_second", 12},
           {"memory_peak_bytes", 4e6},
           {"energy_joules", nullptr},
           {"counters", nullptr},
           {"claims",
            {{"ordering", "FIFO in real time"},
             {"push", "lock-free"},
             {"pop", "lock-free"},
             {"bound", "unbounded"},
             {"reclamation", "hazard pointers"}}},
           {"allocator", "glibc malloc"}};
  if (simulated) {
    run["machine"] = machine;
    run["seeds"] = {1, 2, 3};
    run["band"] = "least and most of three seeds";
    run["transfers_per_operation"] = 2.0 + std::log2(threads);
    run["cas_failures_per_success"] = 0.1 * threads;
    run["waiting"] = {{"another's cache line", 0.7}, {"lock", 0.3}};
  } else {
    run["latency_ns"] = {{"push", latencies(60 + threads)}, {"pop", latencies(80 + threads)}};
  }
  run["conditions"] = conditions();
  return run;
}

Json sweep(const std::vector<std::string>& queues, const std::vector<unsigned>& threads,
           const std::string& machine) {
  Json runs = Json::array();
  for (std::size_t i = 0; i < queues.size(); ++i) {
    for (const unsigned count : threads) {
      // Some scale, some do not, each in a way of its own.
      const double steepness = 0.9 - 0.16 * static_cast<double>(i % 9);
      const double per_second = 4e6 * std::pow(count, steepness) * (machine.empty() ? 1 : 0.9);
      runs.push_back(operations(queues[i], count, per_second, machine));
    }
  }
  return runs;
}

Json frames(const std::string& queue, unsigned threads, unsigned task_size, double fps) {
  return {{"scene", "office"},
          {"triangles", 20'769},
          {"queue", queue},
          {"threads", threads},
          {"bvh", "wide"},
          {"packet_width", nullptr},
          {"task_system", "queue"},
          {"frame_buffer", "fixed-point"},
          {"termination", "outstanding-count"},
          {"shader", "whitted"},
          {"task_size", task_size},
          {"frames", 20},
          {"repetitions", 5},
          {"fps", fps},
          {"fps_lower_quartile", fps * 0.96},
          {"fps_upper_quartile", fps * 1.02},
          {"rays_per_second", fps * 5e5},
          {"speed_up", threads == 1 ? 1 : fps / 9},
          {"get_ns", 90},
          {"get_ns_p99", 900},
          {"get_ns_mean", 150.0 + 20 * threads},
          {"add_ns", 70},
          {"add_ns_p99", 500},
          {"add_ns_mean", 80.0 + 10 * threads},
          {"failed_gets_per_frame", 3.0 * threads},
          {"overflowed_per_frame", 0},
          {"barrier_wait_ms", 0.1 * threads},
          {"idle_ms", 0.05 * threads},
          {"imbalance", 1 + 0.01 * threads},
          {"lost_tasks", 0},
          {"doubled_tasks", 0},
          {"same_image", true},
          {"conditions", conditions()}};
}

Json micro(const std::vector<std::string>& benchmarks) {
  Json document{{"context",
                 {{"date", "2026-01-01T00:00:00+00:00"},
                  {"host_name", "secret-host"},
                  {"executable", "/home/somebody/irt-micro"},
                  {"num_cpus", 64},
                  {"mhz_per_cpu", 3000},
                  {"library_build_type", "release"}}},
                {"benchmarks", Json::array()}};
  double time = 8;
  for (const std::string& name : benchmarks) {
    for (int repetition = 0; repetition < 3; ++repetition) {
      document["benchmarks"].push_back({{"name", name},
                                        {"run_name", name},
                                        {"run_type", "iteration"},
                                        {"repetitions", 3},
                                        {"repetition_index", repetition},
                                        {"threads", 1},
                                        {"iterations", 1'000'000},
                                        {"real_time", time + 0.2 * repetition},
                                        {"cpu_time", time},
                                        {"time_unit", "ns"}});
    }
    document["benchmarks"].push_back({{"name", name + "_mean"},
                                      {"run_name", name},
                                      {"run_type", "aggregate"},
                                      {"aggregate_name", "mean"},
                                      {"repetitions", 3},
                                      {"real_time", 999},
                                      {"time_unit", "ns"}});
    time *= 1.7;
  }
  return document;
}

}  // namespace irt::synthetic
