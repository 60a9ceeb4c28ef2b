#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/summary.hpp"
#include "bench/running/clocks.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/statistics/averages.hpp"
#include "queues/blocking/two_lock_queue.hpp"
#include "renderer/engine/queue_engine.hpp"
#include "renderer/engine/trace_log.hpp"

namespace irt::frames {
namespace {

template <bool measured>
std::unique_ptr<Engine> concrete_engine(const EngineOptions& options,
                                        const Accelerator& accelerator) {
  using Queue = TwoLockQueue<void*>;
  auto queue = std::make_unique<Queue>(options.threads, options.queue_capacity);
  return std::make_unique<QueueEngine<Queue, measured>>(options, std::move(queue), accelerator);
}

// Of all threads of this process: what neighbours on the machine disturb least.
double processor_seconds() {
  return seconds_by(CLOCK_PROCESS_CPUTIME_ID);
}

// By how much `seconds` are more than `base`, round by round.
std::vector<double> changes_to(const std::vector<double>& base,
                               const std::vector<double>& seconds) {
  std::vector<double> changes;
  for (std::size_t i = 0; i < base.size(); ++i) changes.push_back(seconds[i] / base[i] - 1);
  return changes;
}

// Nanoseconds that one push and one pop take together, least of several batches.
template <class Queue>
double pair_ns(Queue& queue) {
  constexpr int batches = 50, pairs = 20'000;
  double least = 1e9;
  for (int batch = 0; batch < batches; ++batch) {
    const double begin = processor_seconds();
    for (int i = 0; i < pairs; ++i) {
      void* task = &least;
      queue.push(0, task);
      queue.pop(0, task);
    }
    least = std::min(least, (processor_seconds() - begin) * 1e9 / pairs);
  }
  return least;
}

}  // namespace

int overhead(OverheadOptions options) {
  check(options.workload);
  if (!options.json.empty()) require_writable(options.json);
  const std::atomic<bool>& cancel = watch_for_interrupt();
  Workload workload(options.workload);

  EngineOptions measured = workload.engine_options(settle_threads(options.threads));
  measured.cancel = &cancel;
  TraceLog log(measured.threads, 1u << 18);
  EngineOptions traced = measured;
  traced.trace = &log;
  EngineOptions plain = measured;
  plain.measure = false;
  constexpr QueueEntry queue = queue_entry<TwoLockQueue>("lock");
  const Accelerator& accelerator = workload.accelerator();
  struct Variant {
    std::string_view name;
    std::unique_ptr<Engine> engine;
    std::vector<double> seconds;  // of processor time, one per round
  };
  std::array variants{
      Variant{"plain, type-erased", make_engine(plain, queue, accelerator), {}},
      Variant{"plain, concrete", concrete_engine<false>(plain, accelerator), {}},
      Variant{"measured, type-erased", make_engine(measured, queue, accelerator), {}},
      Variant{"measured, concrete", concrete_engine<true>(measured, accelerator), {}},
      Variant{"traced, type-erased", make_engine(traced, queue, accelerator), {}},
  };
  // Interleaved, each round in another order; the first round warms up.
  for (unsigned round = 0; round <= options.frames; ++round) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      Variant& variant = variants[(i + round) % variants.size()];
      log.clear();
      const double begin = processor_seconds();
      variant.engine->run(workload.application());
      if (cancel) return exit_interrupted;
      if (round > 0) variant.seconds.push_back(processor_seconds() - begin);
    }
  }

  auto runs = nlohmann::ordered_json::array();
  std::FILE* const people = beside(options.json);
  const auto taken = conditions(options.workload.pin ? "one thread per core" : "none");
  fmt::print(people, "{:<24}{:>14}{:>14}{:>24}\n", "", "CPU ms/frame", "to the first",
             "95 % interval");
  for (const Variant& variant : variants) {
    const std::vector<double> changes = changes_to(variants.front().seconds, variant.seconds);
    const double change = statistics::median(changes);
    const auto [low, high] = statistics::median_interval(changes);
    const double median = statistics::median(variant.seconds);
    fmt::print(people, "{:<24}{:>14.2f}{:>+13.2f}%{:>24}\n", variant.name, 1e3 * median,
               100 * change, fmt::format("{:+.2f} to {:+.2f} %", 100 * low, 100 * high));
    runs.push_back({{"variant", variant.name},
                    {"scene", workload.options().scene},
                    {"threads", measured.threads},
                    {"frames", variant.seconds.size()},
                    {"cpu_seconds_per_frame", median},
                    {"change", change},
                    {"change_low", low},
                    {"change_high", high},
                    {"conditions", taken}});
  }

  // Frames differ by more from run to run than a virtual call costs, so that is measured alone,
  // too.
  TwoLockQueue<void*> concrete(1, 1);
  const auto face = queue.make_task_queue(1, 1);
  const double extra_ns = pair_ns(*face) - pair_ns(concrete);
  const auto tasks =
      static_cast<double>(variants.front().engine->run(workload.application()).total().tasks);
  const double share = extra_ns * 1e-9 * tasks / statistics::median(variants.front().seconds);
  fmt::print(people,
             "\nThe face alone: {:.1f} ns per push and pop, {:.0f} tasks per frame: {:+.4f} %\n",
             extra_ns, tasks, 100 * share);
  if (!options.json.empty()) write_text(options.json, runs.dump(2) + '\n');
  return 0;
}

}  // namespace irt::frames
