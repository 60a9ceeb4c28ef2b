/// The replay against the renderer itself, on the machine at hand.
#pragma once

#include <atomic>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/many_core/renderer/sweep.hpp"
#include "queues/registry.hpp"

namespace irt::many_core {

/// Measures and replays the same frame, with every queue of `options` on every number of its cores;
/// `profile` is this machine's. Measurements go round and round, `rounds` times some frames each.
/// One object per queue and number of cores: queue, threads, measured_fps (median) with quartiles
/// measured_low and measured_high, predicted_fps, ratio (predicted over measured).
std::vector<nlohmann::ordered_json> validate_renderer(frames::Workload& workload,
                                                      const QueueRegistry& registry,
                                                      const Profile& profile,
                                                      const Recording& recording,
                                                      const RendererSweep& options, unsigned rounds,
                                                      const std::atomic<bool>& cancel);

}  // namespace irt::many_core
