#include "bench/many_core/renderer/sweep.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <thread>

#include "bench/many_core/sweeps/children.hpp"
#include "bench/many_core/sweeps/runs.hpp"
#include "bench/results/record.hpp"
#include "bench/statistics/averages.hpp"

namespace irt::many_core {
namespace {

using Json = nlohmann::ordered_json;

struct PointKey {
  std::size_t queue = 0;
  unsigned cores = 0;
  unsigned seed = 0;
};

// The mean of a figure over the seeds.
Json mean_of(const std::vector<Json>& results, const std::string& key) {
  double sum = 0;
  for (const Json& result : results) sum += result[key].get<double>();
  return sum / static_cast<double>(results.size());
}

Json merged(const std::vector<Json>& results) {
  Json run;
  const auto bad =
      std::ranges::find_if(results, [](const Json& result) { return result["status"] != "ok"; });
  if (bad != results.end()) {
    run["status"] = (*bad)["status"];
    run["message"] = (*bad)["message"];
    return run;
  }
  run["status"] = "ok";
  run["message"] = "";
  std::vector<double> fps;
  fps.reserve(results.size());
  for (const Json& result : results) fps.push_back(result["fps"]);
  const auto interval = statistics::student_interval(fps);
  run["fps"] = statistics::mean(fps);
  run["fps_low"] = interval ? Json(interval->low) : Json();
  run["fps_high"] = interval ? Json(interval->high) : Json();
  run["samples"] = fps;
  for (const auto& [key, value] : results.front().items()) {
    if (value.is_number() && key != "fps") run[key] = mean_of(results, key);
  }
  for (const auto& [cause, value] : results.front()["waiting"].items()) {
    double sum = 0;
    for (const Json& result : results) sum += result["waiting"][cause].get<double>();
    run["waiting"][cause] = sum / static_cast<double>(results.size());
  }
  return run;
}

// Against the fastest run on one core, of the whole frame and of what all threads do together
// (RenderLoop of Listing 3.3); null without one.
void add_speed_up(std::vector<Json>& runs, double serial_seconds) {
  const auto done = [](const Json& run) { return run["status"] == "ok"; };
  const auto frame_seconds = [](const Json& run) { return 1 / run["fps"].get<double>(); };
  double one = 0;
  for (const Json& run : runs) {
    if (run["threads"] == 1 && done(run) && (one == 0 || frame_seconds(run) < one)) {
      one = frame_seconds(run);
    }
  }
  for (Json& run : runs) {
    run["speed_up"] = run["loop_speed_up"] = nullptr;
    if (one == 0 || !done(run)) continue;
    run["speed_up"] = one / frame_seconds(run);
    run["loop_speed_up"] = (one - serial_seconds) / (frame_seconds(run) - serial_seconds);
  }
}

}  // namespace

double scale_of(const Pace& pace, const Recording& recording, const Profile& machine) {
  const double frame = recording.work_ns() + recording.generate_ns + recording.output_ns;
  switch (pace.kind) {
    case Pace::Kind::clock:
      return clock_scale(recording, machine);
    case Pace::Kind::factor:
      return pace.value;
    case Pace::Kind::one_core:
      return 1e9 / pace.value / frame;
    case Pace::Kind::mean_task:
      return pace.value * static_cast<double>(recording.tasks.size()) / recording.work_ns();
  }
  return 1;
}

std::vector<Json> sweep_renderer(const Profile& profile, const Recording& recording,
                                 const RendererSweep& options, const std::atomic<bool>& cancel,
                                 const std::function<void()>& on_point) {
  std::vector<PointKey> keys;
  for (const unsigned cores : options.cores) {
    for (std::size_t queue = 0; queue < options.queues.size(); ++queue) {
      for (unsigned seed = 1; seed <= options.seeds; ++seed) keys.push_back({queue, cores, seed});
    }
  }
  std::map<std::pair<std::size_t, unsigned>, std::map<unsigned, Json>> results;
  const auto play = [&](std::size_t i) {
    ReplayOptions replaying = options.replay;
    replaying.queue_module = options.modules[keys[i].queue];
    replaying.threads = keys[i].cores;
    replaying.scale = scale_of(options.pace, recording, profile);
    return replay(profile, recording, replaying, keys[i].seed).dump();
  };
  const auto take = [&](std::size_t i, const ChildResult& child) {
    results[{keys[i].queue, keys[i].cores}][keys[i].seed] =
        child.status == "ok" ? Json::parse(child.text)
                             : Json{{"status", child.status}, {"message", child.message}};
    if (on_point) on_point();
  };
  run_in_children(keys.size(), std::max(1U, std::thread::hardware_concurrency()),
                  options.seconds_per_point, play, take, cancel);

  std::vector<Json> runs;
  for (const auto& [key, by_seed] : results) {
    if (by_seed.size() != options.seeds) continue;
    std::vector<Json> in_order;
    for (const auto& [seed, result] : by_seed) in_order.push_back(result);
    Json run = results::record({{"kind", "simulated"},
                                {"source", "simulated"},
                                {"machine", profile.name},
                                {"queue", options.queues[key.first]},
                                {"threads", key.second},
                                {"work_scale", scale_of(options.pace, recording, profile)},
                                {"seeds", options.seeds},
                                {"levels", levels_of(profile, options.replay.placement)}});
    run.update(merged(in_order));
    runs.push_back(std::move(run));
  }
  const double serial_ns = recording.generate_ns + recording.output_ns;
  add_speed_up(runs, serial_ns * 1e-9 * scale_of(options.pace, recording, profile));
  return runs;
}

void describe(Json& run, const frames::WorkloadOptions& workload, Placement placement,
              const Recording& recording) {
  const double work = recording.work_ns();
  results::add(run, {{"scenario", "renderer"}});
  add_choices(run, workload, results::by_replay);
  results::add(run, {{"placement", name_of(placement)},
                     {"rays_per_frame", recording.rays()},
                     {"recorded_frame_ms", work * 1e-6},
                     {"recorded_spread", recording.spread},
                     {"mean_task_us", work * run["work_scale"].get<double>() /
                                          static_cast<double>(recording.tasks.size()) * 1e-3},
                     {"band",
                      "model: 10-30 % for queues of arrays, up to 2x for locks and linked "
                      "lists (docs/simulator.md)"}});
}

}  // namespace irt::many_core
