/// One simulated run: a queue, or a primitive, under a workload on so many threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bench/many_core/machine/machine.hpp"
#include "bench/many_core/machine/placement.hpp"
#include "stress/scenarios/contention.hpp"

namespace irt::many_core {

/// What is run. Times are simulated nanoseconds.
struct Point {
  std::string subject;           ///< a queue, or a primitive
  std::filesystem::path module;  ///< where its code is
  /// Null: each thread repeats one step of a primitive, and works.
  const contention::Scenario* scenario = nullptr;
  unsigned threads = 1;
  unsigned producers =
      0;               ///< where nobody does both; spread alike over the machine, the others pop
  double work_ns = 0;  ///< after each operation
  std::size_t capacity = 65536;
  Placement placement = Placement::close;
  double warm_up_ns = 200e3, measured_ns = 1e6;
};

/// The scenario's name, or "primitive".
std::string_view scenario_of(const Point& point);

/// Who pushes and who pops, as far as it matters how many; nobody pops of a primitive.
Roles roles_of(const Point& point);

/// Runs `point` and returns what came out, as one object:
///
/// status ("ok", "hung", "failed"), message, pushes, pops, failed_pushes, failed_pops (in the
/// measured time), operations_per_second, fairness, latency (of "push" and "pop": counts per bucket
/// of a TimeHistogram, and the greatest, in ns), order (of the elements, of all operations since
/// the start; null where there are two queues), accesses, transfers, swaps, failed_swaps, sleeps,
/// waiting (by cause: share of all threads' time), hot_lines (with `explain`), cpu_seconds,
/// memory_bytes. Call it once per process.
nlohmann::json simulate(const Profile& profile, const Point& point, std::uint64_t seed,
                        bool explain);

}  // namespace irt::many_core
