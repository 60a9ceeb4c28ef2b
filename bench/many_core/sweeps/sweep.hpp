/// Many simulated points: which, on all of the host's cores, kept as they come.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/many_core/workloads/point.hpp"
#include "stress/running/usage_error.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::many_core {

struct SweepOptions {
  virtual_cores::QueueModules queues;  ///< there are
  std::vector<std::string> machines{"granite-rapids-96"}, subjects, primitives;
  std::vector<unsigned> cores;
  const contention::Scenario* scenario = contention::find_scenario("pairs");
  Placement placement = Placement::close;
  double work_ns = 85, measured_ns = 1e6;
  std::size_t capacity = 65536;
  unsigned seeds = 5;
  std::uint64_t first_seed = 1;
  double timeout_s = 120;
  unsigned jobs = 0;  ///< 0: as many as the host has cores
  std::filesystem::path out = "irt-out", json;
  bool resume = false;
};

/// The primitives, with a line on each.
std::vector<std::pair<std::string, std::string>> primitives();
/// Where the code of a primitive is. Throws UsageError that names the nearest.
std::filesystem::path module_of_primitive(const std::string& name);

/// "1..128" or "1,2,4". Throws UsageError, as the others do.
std::vector<unsigned> parse_cores(std::string_view text);
const contention::Scenario* parse_scenario(std::string_view name);
Placement parse_placement(std::string_view name);

/// `point` with `threads` in the roles of its scenario; a thread that would be left over is left
/// out.
Point with_threads(Point point, unsigned threads);

/// A point on a machine, with its seeds.
struct Task {
  const Profile* profile;
  Point point;
  unsigned seeds = 1;
  std::uint64_t first_seed = 1;
};

/// Simulates all tasks, several seeds and tasks at once. `done(i, run)` is called as soon as the
/// last seed of a task is through. Where `journal` is not empty every result is kept there, and
/// with `resume` those that it has are not simulated again. False if interrupted.
bool simulate_all(std::span<const Task> tasks, const SweepOptions& options,
                  const std::filesystem::path& journal, const std::atomic<bool>& interrupted,
                  const std::function<void(std::size_t, const nlohmann::ordered_json&)>& done);

/// `irt simulate`: the sweep that the options ask for. Returns the exit code.
int simulate_sweep(const SweepOptions& options, const std::atomic<bool>& interrupted);

}  // namespace irt::many_core
