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

namespace irt::many_core {

/// Who does what. Between two operations of a thread lie `work_ns` of work.
enum class Scenario : std::uint8_t {
  pairs,      ///< each thread pushes, works, pops until it gets something, works
  sides,      ///< `producers` threads, spread alike over the machine, push, the others pop
  bursts,     ///< each thread pushes sixteen, then pops sixteen
  primitive,  ///< each thread repeats one step of a primitive, and works
};
std::string_view name_of(Scenario scenario);

/// What is run. Times are simulated nanoseconds.
struct Point {
  std::string subject;           ///< a queue, or a primitive
  std::filesystem::path module;  ///< where its code is
  Scenario scenario = Scenario::pairs;
  unsigned threads = 1;
  unsigned producers = 0;  ///< of `sides`; the other threads pop
  double work_ns = 0;
  std::size_t capacity = 65536;
  Placement placement = Placement::close;
  double warm_up_ns = 200e3, measured_ns = 1e6;
};

/// Runs `point` and returns what came out, as one object:
///
/// status ("ok", "hung", "failed"), message, pushes, pops, failed_pushes, failed_pops (in the
/// measured time), operations_per_second, fairness, latency (of "push" and "pop": counts per bucket
/// of a TimeHistogram, and the greatest, in ns), accesses, transfers, swaps, failed_swaps, sleeps,
/// waiting (by cause: share of all threads' time), hot_lines (with `explain`), cpu_seconds,
/// memory_bytes. Call it once per process.
nlohmann::json simulate(const Profile& profile, const Point& point, std::uint64_t seed,
                        bool explain);

}  // namespace irt::many_core
