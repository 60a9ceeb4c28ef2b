#include <array>
#include <fmt/format.h>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/interrupt.hpp"
#include "bench/frames/summary.hpp"
#include "queues/blocking/two_lock_queue.hpp"
#include "renderer/engine/queue_engine.hpp"

namespace irt {
namespace {

template <bool measured>
std::unique_ptr<Engine> concrete_engine(const EngineOptions& options,
                                        const Accelerator& accelerator) {
  using Queue = TwoLockQueue<void*>;
  auto queue = std::make_unique<Queue>(options.threads, options.queue_capacity);
  return std::make_unique<QueueEngine<Queue, measured>>(options, std::move(queue), accelerator);
}

}  // namespace

int overhead(OverheadOptions options) {
  check(options.workload);
  if (!options.json.empty()) require_writable(options.json);
  const std::atomic<bool>& cancel = watch_for_interrupt();
  Workload workload(options.workload);

  EngineOptions measured = workload.engine_options(settle_threads(options.threads));
  measured.cancel = &cancel;
  EngineOptions plain = measured;
  plain.measure = false;
  constexpr QueueEntry queue = queue_entry<TwoLockQueue>("lock");
  const Accelerator& accelerator = workload.accelerator();
  struct Variant {
    std::string_view name;
    std::unique_ptr<Engine> engine;
    std::vector<double> seconds;
  };
  std::array variants{
      Variant{"plain, type-erased", make_engine(plain, queue, accelerator), {}},
      Variant{"plain, concrete", concrete_engine<false>(plain, accelerator), {}},
      Variant{"measured, type-erased", make_engine(measured, queue, accelerator), {}},
      Variant{"measured, concrete", concrete_engine<true>(measured, accelerator), {}},
  };
  // Interleaved, each round in another order; the first round warms up.
  for (unsigned round = 0; round <= options.frames && !cancel; ++round) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      Variant& variant = variants[(i + round) % variants.size()];
      const FrameStats stats = variant.engine->run(workload.application());
      if (round > 0 && !stats.cancelled) variant.seconds.push_back(stats.seconds());
    }
  }
  if (std::ranges::any_of(variants, [](const Variant& v) { return v.seconds.empty(); })) {
    return exit_interrupted;
  }

  auto runs = nlohmann::ordered_json::array();
  const auto taken = conditions(options.workload.pin ? "one thread per core" : "none");
  fmt::print("{:<24}{:>12}{:>26}{:>12}\n", "", "ms per frame", "quartiles", "to first");
  const double base = quantile(variants[0].seconds, 0.5);
  for (const Variant& variant : variants) {
    const double median = quantile(variant.seconds, 0.5);
    const double low = quantile(variant.seconds, 0.25), high = quantile(variant.seconds, 0.75);
    fmt::print("{:<24}{:>12.2f}{:>26}{:>+11.2f}%\n", variant.name, 1e3 * median,
               fmt::format("{:.2f} to {:.2f}", 1e3 * low, 1e3 * high), 100 * (median / base - 1));
    runs.push_back({{"variant", variant.name},
                    {"scene", workload.options().scene},
                    {"threads", measured.threads},
                    {"frames", variant.seconds.size()},
                    {"seconds_per_frame", median},
                    {"lower_quartile", low},
                    {"upper_quartile", high},
                    {"conditions", taken}});
  }
  if (!options.json.empty()) write_text(options.json, runs.dump(2) + '\n');
  return cancel ? exit_interrupted : 0;
}

}  // namespace irt
