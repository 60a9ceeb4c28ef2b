#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <optional>
#include <thread>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/sample.hpp"
#include "bench/frames/summary.hpp"
#include "bench/frames/trace_file.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/progress.hpp"
#include "renderer/engine/trace_log.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::frames {

unsigned settle_threads(unsigned threads) {
  if (threads > max_threads) {
    throw UsageError(fmt::format("--threads {}: must be from 1 to {}", threads, max_threads));
  }
  return threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
}

namespace {

// Spans in memory over all threads: 32 MB.
constexpr std::size_t spans_in_trace = 1u << 20;

void check_trace(const RenderOptions& options) {
  if (options.trace.empty()) return;
  if (options.plain) {
    throw UsageError("--trace with --plain: a trace is made of clock readings; leave --plain out");
  }
  if (!uses_queue(options.workload)) {
    throw UsageError(
        fmt::format("--trace: the task system {} does not tell when it takes a task; --task-system "
                    "queue does",
                    options.workload.task_system));
  }
}

void check_image(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (file.empty() || extension.empty() || extension == ".png") return;
  throw UsageError(fmt::format("--image {}: pictures are written as PNG; name it {}", file.string(),
                               std::filesystem::path(file).replace_extension(".png").string()));
}

}  // namespace

void check_queue(const std::string& queue, const WorkloadOptions& workload) {
  if (queue.empty() || uses_queue(workload)) return;
  throw UsageError(
      fmt::format("--queue {}: the task system {} has a queue of its own; --task-system queue "
                  "uses this one",
                  queue, workload.task_system));
}

int render(RenderOptions options, const QueueRegistry& queues) {
  const QueueEntry& queue = options.queue.empty() ? queues.first() : queues.at(options.queue);
  const unsigned threads = settle_threads(options.threads);
  check(options.workload);
  check_queue(options.queue, options.workload);
  check_image(options.image);
  check_trace(options);
  for (const auto& file : {options.image, options.json, options.csv, options.trace}) {
    if (!file.empty()) require_writable(file);
  }
  const std::atomic<bool>& cancel = watch_for_interrupt();
  Workload workload(options.workload);
  const auto taken = conditions(options.workload.pin ? "one thread per core" : "none");

  // Frame by frame, so that there is something to show on the way.
  ProgressBar progress(options.frames, 0);
  progress.show("rendering");
  std::optional<TraceLog> log;
  if (!options.trace.empty()) log.emplace(threads, spans_in_trace / (threads + 1));
  const SampleOptions sampling{.threads = threads,
                               .warmup = options.warmup,
                               .frames = options.frames,
                               .measure = !options.plain,
                               .trace = log ? &*log : nullptr};
  Sample sample = take_sample(workload, queue, sampling, cancel, [&](bool counted) {
    if (counted) progress.step();
    progress.show("rendering");
  });
  if (sample.seconds.empty()) {
    fmt::print(stderr, "irt: interrupted before anything was measured\n");
    return exit_interrupted;
  }
  std::optional<double> traverse;
  if (options.plain) traverse = 0;
  if (!options.plain && !cancel) traverse = traverse_share(workload, queue, threads, cancel);
  if (cancel) {
    sample.status = "interrupted";
    sample.message = fmt::format("after {} of {} frames", sample.seconds.size(), options.frames);
  }

  const Background background{.workload = workload.options(),
                              .triangles = workload.scene().mesh.triangles.size(),
                              .warmup = options.warmup,
                              .traverse_share = traverse,
                              .conditions = taken};
  const auto runs = summarise({&sample, 1}, {&background, 1});
  const auto& run = runs[0];
  const auto number = [&](const char* name) { return run[name].get<double>(); };
  const auto percent = [&](const char* name) { return 100 * run[name].get<double>(); };
  if (options.json != "-" && options.csv != "-") {
    fmt::print("{}\n", table(runs));
    if (takes_turns(queue.claims, threads) && uses_queue(options.workload))
      fmt::print("{}\n", note_on_turns(queue));
    fmt::print(
        "T.Exec        {:.2f} ms per frame: GenPrimRays {:.2f} %, RenderLoop {:.2f} %, "
        "Output {:.2f} %\n",
        1e3 * number("seconds_per_frame"), percent("share_generate"), percent("share_render_loop"),
        percent("share_output"));
    if (workload.animated()) {
      fmt::print(
          "{:<14}pose {:.2f} ms, {} {:.2f} ms per frame, rebuilt in {:.0f} % of the frames; part "
          "of "
          "T.Exec\n",
          workload.options().animate, number("pose_ms"), workload.options().update,
          number("update_ms"), percent("share_rebuilt"));
    }
    if (!options.plain) {
      fmt::print("RenderLoop    {}Shade {:.1f} %, {}waiting {:.1f} %; imbalance {:.2f}\n",
                 traverse ? fmt::format("Traverse {:.1f} %, Intersect {:.1f} %, ",
                                        percent("share_traverse"), percent("share_intersect"))
                          : "",
                 percent("share_shade"),
                 run["share_queue"].is_null()
                     ? ""
                     : fmt::format("queue {:.2f} %, ", percent("share_queue")),
                 percent("share_waiting"), number("imbalance"));
    }
    fmt::print("frame         {:.0f} rays in {:.0f} tasks, hash {}, threads {}\n",
               number("rays_per_frame"), number("tasks_per_frame"), sample.image_hash,
               sample.pinned ? "pinned" : "not pinned");
  }
  if (log) {
    write_trace(options.trace, *log,
                {{"scene", workload.options().scene},
                 {"queue", queue.name},
                 {"threads", threads},
                 {"conditions", taken}});
  }
  if (!options.image.empty()) write_png(options.image, workload.application().image());
  if (!options.json.empty()) write_text(options.json, runs.dump(2) + '\n');
  if (!options.csv.empty()) write_text(options.csv, csv(runs));
  if (sample.lost + sample.doubled != 0 ||
      (!sample.same_image && has_exact_sums(workload.options()))) {
    fmt::print(stderr,
               "irt: the queue {} is broken: {} tasks lost, {} handed out twice, images {}\n",
               queue.name, sample.lost, sample.doubled, sample.same_image ? "equal" : "differ");
    return 1;
  }
  return cancel ? exit_interrupted : 0;
}

}  // namespace irt::frames
