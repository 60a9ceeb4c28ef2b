/// Simulated runs on a machine of round figures.
#pragma once

#include <atomic>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/many_core/sweeps/children.hpp"
#include "bench/many_core/workloads/point.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::many_core {

// Round figures, so that the sums below can be checked by hand.
inline Profile simple_machine() {
  return parse_profile(R"({
    "name": "simple", "summary": "one socket of 32 cores",
    "topology": {"sockets": 1, "nodes_per_socket": 1, "caches_per_node": 1, "cores_per_cache": 32,
                 "smt": 1, "cores": 32, "source": "made up"},
    "clock_ghz": [3, "made up"],
    "load_hit": [1, "made up"], "store_hit": [0.5, "made up"], "rmw_hit": [5, "made up"],
    "plain_op": [0.5, "made up"], "pause": [10, "made up"],
    "transfer": {"same_cache": [50, "made up"]},
    "shared_fetch": [0.8, "made up"], "dram": [100, "made up"],
    "overlap": [0.1, "made up"], "conflict": [10, "made up"], "read_occupancy": [10, "made up"],
    "invalidate_per_sharer": [3, "made up"]
  })",
                       "simple.json");
}

inline Point primitive(const std::string& name, unsigned threads, double work_ns) {
  return {.subject = name,
          .module = IRT_CONTENDED,
          .threads = threads,
          .work_ns = work_ns,
          .warm_up_ns = 100e3,
          .measured_ns = 500e3};
}

inline Point queue(const std::string& name, std::string_view scenario, unsigned threads) {
  return {.subject = name,
          .module = virtual_cores::QueueModules().at(name),
          .scenario = contention::find_scenario(scenario),
          .threads = threads,
          .producers = contention::find_scenario(scenario)->roles(threads).producers,
          .work_ns = 85,
          .capacity = 64,
          .warm_up_ns = 50e3,
          .measured_ns = 200e3};
}

// In a process of its own, as every simulation.
inline nlohmann::json run(const Profile& profile, const Point& point, std::uint64_t seed = 1,
                          bool explain = false) {
  nlohmann::json result;
  const std::atomic<bool> never_interrupted{false};
  run_in_children(
      1, 1, 60, [&](std::size_t) { return simulate(profile, point, seed, explain).dump(); },
      [&](std::size_t, const ChildResult& child) {
        ASSERT_EQ(child.status, "ok") << child.message << child.text;
        result = nlohmann::json::parse(child.text);
      },
      never_interrupted);
  return result;
}

inline nlohmann::json run(const Point& point, std::uint64_t seed = 1, bool explain = false) {
  return run(simple_machine(), point, seed, explain);
}

}  // namespace irt::many_core
