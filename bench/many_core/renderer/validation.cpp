#include "bench/many_core/renderer/validation.hpp"

#include <map>

#include "bench/frames/sample.hpp"
#include "bench/statistics/averages.hpp"

namespace irt::many_core {

std::vector<nlohmann::ordered_json> validate_renderer(frames::Workload& workload,
                                                      const QueueRegistry& registry,
                                                      const Profile& profile,
                                                      const Recording& recording,
                                                      const RendererSweep& options, unsigned rounds,
                                                      const std::atomic<bool>& cancel) {
  std::map<std::pair<std::string, unsigned>, std::vector<double>> seconds;
  for (unsigned round = 0; round < rounds; ++round) {
    for (const unsigned threads : options.cores) {
      for (const std::string& queue : options.queues) {
        const frames::SampleOptions sampling{.threads = threads, .warmup = 1, .frames = 4};
        const frames::Sample sample =
            frames::take_sample(workload, registry.at(queue), sampling, cancel);
        auto& all = seconds[{queue, threads}];
        all.insert(all.end(), sample.seconds.begin(), sample.seconds.end());
      }
    }
  }
  auto runs = sweep_renderer(profile, recording, options, cancel, nullptr);
  if (cancel) return {};
  std::vector<nlohmann::ordered_json> compared;
  for (const auto& run : runs) {
    const auto& measured =
        seconds[{run["queue"].get<std::string>(), run["threads"].get<unsigned>()}];
    nlohmann::ordered_json line{{"kind", "validation"},
                                {"queue", run["queue"]},
                                {"threads", run["threads"]},
                                {"measured_fps", 1 / statistics::median(measured)},
                                {"measured_low", 1 / statistics::quantile(measured, 0.75)},
                                {"measured_high", 1 / statistics::quantile(measured, 0.25)},
                                {"status", run["status"]},
                                {"message", run["message"]}};
    if (run["status"] == "ok") {
      line["predicted_fps"] = run["fps"];
      line["ratio"] = run["fps"].get<double>() * statistics::median(measured);
    }
    compared.push_back(std::move(line));
  }
  return compared;
}

}  // namespace irt::many_core
