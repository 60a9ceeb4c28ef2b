#include "bench/frames/summary.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace irt {
namespace {

using Json = nlohmann::ordered_json;

// All samples of one queue with so many threads, as one.
struct Group {
  Sample sum;
  unsigned repetitions = 0;
};

std::vector<Group> group(std::span<const Sample> samples) {
  std::vector<Group> groups;
  for (const Sample& sample : samples) {
    auto found = std::ranges::find_if(groups, [&](const Group& group) {
      return group.sum.queue == sample.queue && group.sum.threads == sample.threads;
    });
    if (found == groups.end()) {
      groups.push_back({sample, 1});
      continue;
    }
    Sample& sum = found->sum;
    sum.seconds.insert(sum.seconds.end(), sample.seconds.begin(), sample.seconds.end());
    for (double Sample::*field :
         {&Sample::generate_s, &Sample::render_s, &Sample::output_s, &Sample::barrier_s,
          &Sample::idle_s, &Sample::trace_s, &Sample::shade_s, &Sample::get_s, &Sample::add_s,
          &Sample::imbalance}) {
      sum.*field += sample.*field;
    }
    for (std::uint64_t Sample::*field :
         {&Sample::rays, &Sample::tasks, &Sample::added, &Sample::failed_gets, &Sample::overflowed,
          &Sample::lost, &Sample::doubled}) {
      sum.*field += sample.*field;
    }
    add_counts(sum.gets, sample.gets);
    add_counts(sum.adds, sample.adds);
    sum.same_image &= sample.same_image && sample.image_hash == sum.image_hash;
    ++found->repetitions;
  }
  std::erase_if(groups, [](const Group& group) { return group.sum.seconds.empty(); });
  return groups;
}

double per(double sum, double count) {
  return count > 0 ? sum / count : 0;
}

TimeHistogram histogram(const std::vector<std::uint64_t>& counts) {
  TimeHistogram times;
  std::copy_n(counts.begin(), std::min(counts.size(), times.counts.size()), times.counts.begin());
  return times;
}

Json run_of(const Group& group, const Background& background, double one_thread_fps) {
  const Sample& sum = group.sum;
  const WorkloadOptions& options = background.workload;
  const auto frames = static_cast<double>(sum.seconds.size());
  const double fps = 1 / quantile(sum.seconds, 0.5);
  const double all_s = sum.generate_s + sum.render_s + sum.output_s;
  const double threads_s = sum.render_s * sum.threads;
  const double rays_per_frame = per(static_cast<double>(sum.rays), frames);
  const TimeHistogram gets = histogram(sum.gets), adds = histogram(sum.adds);
  const auto share = [](double part, double whole) { return per(part, whole); };
  return {
      {"scene", options.scene},
      {"triangles", background.triangles},
      {"queue", sum.queue},
      {"threads", sum.threads},
      {"bvh", options.bvh},
      {"frame_buffer", options.frame_buffer},
      {"termination", options.termination},
      {"shader", options.shader},
      {"task_size", options.task_size},
      {"packet_width", 1},
      {"width", options.width},
      {"height", options.height},
      {"depth", options.depth},
      {"samples_per_pixel", options.samples_per_pixel},
      {"warmup", background.warmup},
      {"frames", sum.seconds.size()},
      {"repetitions", group.repetitions},
      {"fps", fps},
      {"fps_lower_quartile", 1 / quantile(sum.seconds, 0.75)},
      {"fps_upper_quartile", 1 / quantile(sum.seconds, 0.25)},
      {"seconds_per_frame", 1 / fps},
      {"rays_per_frame", rays_per_frame},
      {"rays_per_second", rays_per_frame * fps},
      {"speed_up", one_thread_fps > 0 ? Json(fps / one_thread_fps) : Json()},
      {"tasks_per_frame", per(static_cast<double>(sum.tasks), frames)},
      {"get_ns", gets.quantile(0.5)},
      {"get_ns_p99", gets.quantile(0.99)},
      {"get_ns_mean", per(sum.get_s * 1e9, static_cast<double>(sum.tasks))},
      {"add_ns", adds.quantile(0.5)},
      {"add_ns_p99", adds.quantile(0.99)},
      {"add_ns_mean", per(sum.add_s * 1e9, static_cast<double>(sum.added))},
      {"failed_gets_per_frame", per(static_cast<double>(sum.failed_gets), frames)},
      {"overflowed_per_frame", per(static_cast<double>(sum.overflowed), frames)},
      {"barrier_wait_ms", per(sum.barrier_s * 1e3, frames * sum.threads)},
      {"idle_ms", per(sum.idle_s * 1e3, frames * sum.threads)},
      {"imbalance", per(sum.imbalance, frames)},
      // Of T.Exec, as tables 5.3 and 7.3 of the thesis.
      {"share_generate", share(sum.generate_s, all_s)},
      {"share_render_loop", share(sum.render_s, all_s)},
      {"share_output", share(sum.output_s, all_s)},
      // Of the time of all render threads in the RenderLoop, as table 5.4.
      {"share_traverse", share(sum.trace_s * background.traverse_share, threads_s)},
      {"share_intersect", share(sum.trace_s * (1 - background.traverse_share), threads_s)},
      {"share_shade", share(sum.shade_s, threads_s)},
      {"share_queue", share(sum.get_s + sum.add_s, threads_s)},
      {"share_waiting", share(sum.idle_s + sum.barrier_s, threads_s)},
      {"clock_ns", clock_cost_ns()},
      {"lost_tasks", sum.lost},
      {"doubled_tasks", sum.doubled},
      {"image_hash", sum.image_hash},
      {"same_image", sum.same_image},
      {"pinned", sum.pinned},
      {"conditions", background.conditions},
  };
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  std::ranges::sort(values);
  const double at = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (values[above] - values[below]) * (at - static_cast<double>(below));
}

nlohmann::ordered_json summarise(std::span<const Sample> samples, const Background& background) {
  const std::vector<Group> groups = group(samples);
  double one_thread_fps = 0;
  for (const Group& one : groups) {
    if (one.sum.threads != 1) continue;
    one_thread_fps = std::max(one_thread_fps, 1 / quantile(one.sum.seconds, 0.5));
  }
  Json runs = Json::array();
  for (const Group& one : groups) runs.push_back(run_of(one, background, one_thread_fps));
  return runs;
}

std::string table(const nlohmann::ordered_json& runs) {
  // FPS with quartiles, Mrays/s, speed-up, ns per task in get and add, pops that failed per frame,
  // ms per frame and thread without work and at the barrier.
  std::string text = fmt::format("{:<16}{:>8}{:>9}  {:<17}{:>9}{:>9}{:>8}{:>8}{:>9}{:>9}{:>9}\n",
                                 "queue", "threads", "FPS", "quartiles", "Mrays/s", "speed-up",
                                 "get ns", "add ns", "failed", "idle ms", "barr. ms");
  std::string last;
  for (const auto& run : runs) {
    const auto queue = run["queue"].get<std::string>();
    if (!last.empty() && queue != last) text += '\n';
    last = queue;
    const std::string speed_up =
        run["speed_up"].is_null() ? "-" : fmt::format("{:.2f}", run["speed_up"].get<double>());
    text += fmt::format(
        "{:<16}{:>8}{:>9.2f}  {:<17}{:>9.3f}{:>9}{:>8.0f}{:>8.0f}{:>9.0f}{:>9.2f}{:>9.2f}\n", queue,
        run["threads"].get<unsigned>(), run["fps"].get<double>(),
        fmt::format("{:.2f} to {:.2f}", run["fps_lower_quartile"].get<double>(),
                    run["fps_upper_quartile"].get<double>()),
        run["rays_per_second"].get<double>() / 1e6, speed_up, run["get_ns"].get<double>(),
        run["add_ns"].get<double>(), run["failed_gets_per_frame"].get<double>(),
        run["idle_ms"].get<double>(), run["barrier_wait_ms"].get<double>());
  }
  return text;
}

std::string csv(const nlohmann::ordered_json& runs) {
  std::string names, lines;
  for (const auto& run : runs) {
    std::string line;
    names.clear();
    for (const auto& [name, value] : run.items()) {
      if (name == "conditions") continue;
      names += names.empty() ? name : "," + name;
      line += (line.empty() ? "" : ",") + (value.is_null() ? std::string() : value.dump());
    }
    lines += line + '\n';
  }
  return names + '\n' + lines;
}

}  // namespace irt
