#include "bench/frames/sample.hpp"

#include <fmt/format.h>
#include <optional>

#include "renderer/engine/trace_log.hpp"

namespace irt::frames {
namespace {

// Of all frames so far, `before` being that of all but the last.
std::string hash_of_all(const std::string& before, const std::string& last) {
  const std::string both = before + last;
  return fmt::format("{:016x}",
                     fnv1a({reinterpret_cast<const std::uint8_t*>(both.data()), both.size()}));
}

}  // namespace

void add_counts(std::vector<std::uint64_t>& sum, std::span<const std::uint64_t> counts) {
  while (!counts.empty() && counts.back() == 0) counts = counts.first(counts.size() - 1);
  if (sum.size() < counts.size()) sum.resize(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) sum[i] += counts[i];
}

void Sample::add(const FrameStats& frame, const Motion& motion) {
  constexpr double s_per_ns = 1e-9;
  const auto in_s = [](std::uint64_t ns) { return static_cast<double>(ns) * s_per_ns; };
  const WorkerStats total = frame.total();
  seconds.push_back(motion.seconds() + frame.seconds());
  pose_s += motion.pose_s;
  update_s += motion.update_s;
  rebuilds += motion.rebuilt ? 1 : 0;
  generate_s += frame.generate_s;
  render_s += frame.render_s;
  output_s += frame.output_s;
  barrier_s += in_s(total.barrier_ns);
  idle_s += in_s(total.idle_ns);
  trace_s += in_s(total.trace_ns);
  shade_s += in_s(total.shade_ns);
  get_s += in_s(total.get_ns);
  add_s += in_s(total.add_ns);
  imbalance += frame.imbalance();
  rays += frame.rays();
  tasks += total.tasks;
  added += total.added;
  failed_gets += total.failed_gets;
  overflowed += total.overflowed;
  lost += frame.lost;
  doubled += frame.doubled;
  add_counts(gets, total.gets.counts);
  add_counts(adds, total.adds.counts);
}

Sample take_sample(Workload& workload, const QueueEntry& queue, const SampleOptions& options,
                   const std::atomic<bool>& cancel, const std::function<void(bool)>& on_frame) {
  EngineOptions engine_options = workload.engine_options(options.threads);
  engine_options.measure = options.measure;
  engine_options.cancel = &cancel;
  engine_options.trace = options.trace;
  const auto engine = workload.start_engine(engine_options, queue);
  Sample sample;
  sample.queue = uses_queue(workload.options()) ? queue.name : "-";
  sample.threads = options.threads;
  sample.pinned = engine->pinned();
  std::optional<ThreadExecutor> executor;  // as many threads update as render
  if (workload.animated()) workload.rewind(executor.emplace(options.threads));
  double render_s = 0;
  for (unsigned frame = 0; frame < options.warmup + options.frames && !cancel; ++frame) {
    Motion motion;
    if (executor && frame > 0) motion = workload.advance(frame, *executor, render_s);
    const FrameStats stats = engine->run(workload.application());
    if (stats.cancelled) break;
    render_s = stats.render_s;
    // The hash is taken outside of the measured time.
    const std::string hash = workload.image_hash();
    if (executor) {
      sample.image_hash = hash_of_all(sample.image_hash, hash);
    } else {
      if (!sample.image_hash.empty()) sample.same_image &= hash == sample.image_hash;
      sample.image_hash = hash;
    }
    const bool counted = frame >= options.warmup;
    if (counted) {
      sample.add(stats, motion);
    } else {
      if (options.trace != nullptr) options.trace->clear();
      sample.lost += stats.lost;
      sample.doubled += stats.doubled;
    }
    if (on_frame) on_frame(counted);
  }
  return sample;
}

std::optional<double> traverse_share(Workload& workload, const QueueEntry& queue, unsigned threads,
                                     const std::atomic<bool>& cancel) {
  EngineOptions options = workload.engine_options(threads);
  options.profile_every = 8;
  options.cancel = &cancel;
  const auto engine = workload.start_engine(options, queue);
  const FrameStats frame = engine->run(workload.application());
  if (frame.cancelled) return std::nullopt;
  const TraceProfile profile = frame.total().profile;
  const auto traverse = static_cast<double>(profile.traverse_ns);
  const double all = traverse + static_cast<double>(profile.intersect_ns);
  return all > 0 ? traverse / all : 0;
}

}  // namespace irt::frames
