/// `irt simulate --renderer`: frame rates of the renderer on machines that are not there.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/many_core/renderer/replay.hpp"

namespace irt::many_core {

/// How long the recorded work takes on the simulated machine.
struct Pace {
  enum class Kind : std::uint8_t {
    clock,      ///< as recorded, by the ratio of the clocks
    factor,     ///< `value` times as recorded
    one_core,   ///< so that one core's work alone makes `value` frames a second
    mean_task,  ///< so that the mean task takes `value` nanoseconds
  };
  Kind kind = Kind::clock;
  double value = 0;
};

/// The factor that `pace` means for `recording` on `machine`.
double scale_of(const Pace& pace, const Recording& recording, const Profile& machine);

/// One curve's worth of points: what stays the same.
struct RendererSweep {
  std::vector<std::string> queues{};
  std::vector<unsigned> cores{};
  std::vector<std::filesystem::path> modules{};  ///< of each queue, on virtual cores
  ReplayOptions replay{};                        ///< but for its queue, threads and scale
  Pace pace{};
  unsigned seeds = 3;
  double seconds_per_point = 600;  ///< of this host; who takes longer hangs
};

/// Replays every queue on every number of cores with every seed, in processes of their own, as many
/// at a time as the host has cores. Returns one flat object per queue and number of cores, those
/// that are not done left out when `cancel` becomes true. `on_point` hears of every process that
/// ends.
std::vector<nlohmann::ordered_json> sweep_renderer(const Profile& profile,
                                                   const Recording& recording,
                                                   const RendererSweep& options,
                                                   const std::atomic<bool>& cancel,
                                                   const std::function<void()>& on_point);

/// Adds to a run of `sweep_renderer` which workload was replayed.
void describe(nlohmann::ordered_json& run, const frames::WorkloadOptions& workload,
              Placement placement, const Recording& recording);

/// The command; `arguments` without the name of the program. Throws UsageError, SceneError,
/// ProfileError and CLI::Error.
int simulate_renderer(const std::vector<std::string>& arguments);

}  // namespace irt::many_core
