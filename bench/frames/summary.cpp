#include "bench/frames/summary.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "bench/conditions/conditions.hpp"
#include "bench/results/record.hpp"
#include "bench/statistics/averages.hpp"

namespace irt::frames {
namespace {

using Json = nlohmann::ordered_json;

// All samples of one workload and queue with so many threads, as one.
struct Group {
  Sample sum;               // its status is the first that is not ok
  std::vector<double> fps;  // median of each repetition
};

void note_trouble(Sample& sum, const Sample& sample) {
  if (sum.status != "ok") return;
  sum.status = sample.status;
  sum.message = sample.message;
}

std::vector<Group> group(std::span<const Sample> samples) {
  std::vector<Group> groups;
  for (const Sample& sample : samples) {
    const bool measured = !sample.seconds.empty();
    if (!measured && sample.status == "ok") continue;
    auto found = std::ranges::find_if(groups, [&](const Group& group) {
      return group.sum.workload == sample.workload && group.sum.queue == sample.queue &&
             group.sum.threads == sample.threads;
    });
    const bool first = found == groups.end();
    if (first) found = groups.insert(found, {sample, {}});
    if (measured) found->fps.push_back(1 / statistics::median(sample.seconds));
    Sample& sum = found->sum;
    if (first) continue;
    note_trouble(sum, sample);
    if (!measured) continue;
    if (sum.seconds.empty()) sum.image_hash = sample.image_hash;
    sum.seconds.insert(sum.seconds.end(), sample.seconds.begin(), sample.seconds.end());
    for (double Sample::*field :
         {&Sample::pose_s, &Sample::update_s, &Sample::generate_s, &Sample::render_s,
          &Sample::output_s, &Sample::barrier_s, &Sample::idle_s, &Sample::trace_s,
          &Sample::shade_s, &Sample::get_s, &Sample::add_s, &Sample::imbalance}) {
      sum.*field += sample.*field;
    }
    for (std::uint64_t Sample::*field :
         {&Sample::rebuilds, &Sample::rays, &Sample::tasks, &Sample::added, &Sample::failed_gets,
          &Sample::overflowed, &Sample::lost, &Sample::doubled}) {
      sum.*field += sample.*field;
    }
    add_counts(sum.gets, sample.gets);
    add_counts(sum.adds, sample.adds);
    sum.same_image &= sample.same_image && sample.image_hash == sum.image_hash;
  }
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
  const bool measured = !sum.seconds.empty();
  const double fps = measured ? 1 / statistics::median(sum.seconds) : 0;
  const double all_s = sum.pose_s + sum.update_s + sum.generate_s + sum.render_s + sum.output_s;
  const double threads_s = sum.render_s * sum.threads;
  const double rays_per_frame = per(static_cast<double>(sum.rays), frames);
  const TimeHistogram gets = histogram(sum.gets), adds = histogram(sum.adds);
  const auto repeated = statistics::student_interval(group.fps);
  const auto share = [](double part, double whole) { return per(part, whole); };
  const bool queued = sum.queue != "-";
  const auto of_motion = [&](double figure) {
    return options.animate.empty() ? Json() : Json(figure);
  };
  std::optional<double> intersect_share;
  if (background.traverse_share) intersect_share = 1 - *background.traverse_share;
  const auto of_tracing = [&](std::optional<double> part) {
    return part ? Json(share(sum.trace_s * *part, threads_s)) : Json();
  };
  const auto of_queue = [queued](double figure) { return queued ? Json(figure) : Json(); };
  Json run = results::record({
      {"scene", options.scene},
      {"triangles", background.triangles},
      {"queue", queued ? Json(sum.queue) : Json()},
      {"threads", sum.threads},
  });
  add_choices(run, options, results::by_render);
  results::add(run, {
                        {"warmup", background.warmup},
                        {"status", sum.status},
                        {"message", sum.message},
                        {"frames", sum.seconds.size()},
                        {"repetitions", group.fps.size()},
                    });
  Json figures = results::record({
      {"fps", fps},
      {"fps_low", repeated ? Json(repeated->low) : Json()},
      {"fps_high", repeated ? Json(repeated->high) : Json()},
      {"fps_samples", group.fps},
      {"fps_lower_quartile", measured ? 1 / statistics::quantile(sum.seconds, 0.75) : 0},
      {"fps_upper_quartile", measured ? 1 / statistics::quantile(sum.seconds, 0.25) : 0},
      {"seconds_per_frame", measured ? 1 / fps : 0},
      {"frame_ms_p99", measured ? statistics::quantile(sum.seconds, 0.99) * 1e3 : 0},
      {"rays_per_frame", rays_per_frame},
      {"rays_per_second", rays_per_frame * fps},
      {"speed_up", one_thread_fps > 0 ? Json(fps / one_thread_fps) : Json()},
      {"tasks_per_frame", per(static_cast<double>(sum.tasks), frames)},
      {"get_ns", of_queue(gets.quantile(0.5))},
      {"get_ns_p99", of_queue(gets.quantile(0.99))},
      {"get_ns_mean", of_queue(per(sum.get_s * 1e9, static_cast<double>(sum.tasks)))},
      {"add_ns", of_queue(adds.quantile(0.5))},
      {"add_ns_p99", of_queue(adds.quantile(0.99))},
      {"add_ns_mean", of_queue(per(sum.add_s * 1e9, static_cast<double>(sum.added)))},
      {"failed_gets_per_frame", per(static_cast<double>(sum.failed_gets), frames)},
      {"overflowed_per_frame", per(static_cast<double>(sum.overflowed), frames)},
      {"barrier_wait_ms", per(sum.barrier_s * 1e3, frames * sum.threads)},
      {"idle_ms", per(sum.idle_s * 1e3, frames * sum.threads)},
      {"imbalance", per(sum.imbalance, frames)},
      {"work_per_task_ns",
       of_queue(per((sum.trace_s + sum.shade_s) * 1e9, static_cast<double>(sum.tasks)))},
      // Of a scene that moves: per frame, and in which share of the frames the tree was rebuilt.
      {"pose_ms", of_motion(per(sum.pose_s * 1e3, frames))},
      {"update_ms", of_motion(per(sum.update_s * 1e3, frames))},
      {"share_rebuilt", of_motion(per(static_cast<double>(sum.rebuilds), frames))},
      // Of T.Exec, as tables 5.3 and 7.3 of the thesis.
      {"share_generate", share(sum.generate_s, all_s)},
      {"share_render_loop", share(sum.render_s, all_s)},
      {"share_output", share(sum.output_s, all_s)},
      // Of the time of all render threads in the RenderLoop, as table 5.4.
      {"share_traverse", of_tracing(background.traverse_share)},
      {"share_intersect", of_tracing(intersect_share)},
      {"share_shade", share(sum.shade_s, threads_s)},
      {"share_queue", of_queue(share(sum.get_s + sum.add_s, threads_s))},
      {"share_waiting", share(sum.idle_s + sum.barrier_s, threads_s)},
      {"clock_ns", clock_cost_ns()},
      {"allocator", allocator()},
      {"lost_tasks", sum.lost},
      {"doubled_tasks", sum.doubled},
      {"image_hash", sum.image_hash},
      {"same_image", sum.same_image},
      {"pinned", sum.pinned},
  });
  for (auto& [name, figure] : figures.items()) {
    run[name] = measured ? std::move(figure) : Json();
  }
  results::add(run, {{"conditions", background.conditions}});
  return run;
}

}  // namespace

nlohmann::ordered_json summarise(std::span<const Sample> samples,
                                 std::span<const Background> backgrounds) {
  const std::vector<Group> groups = group(samples);
  std::vector<double> one_thread_fps(backgrounds.size());
  for (const Group& one : groups) {
    if (one.sum.threads != 1 || one.sum.seconds.empty()) continue;
    double& fps = one_thread_fps[one.sum.workload];
    fps = std::max(fps, 1 / statistics::median(one.sum.seconds));
  }
  Json runs = Json::array();
  for (const Group& one : groups) {
    const unsigned workload = one.sum.workload;
    runs.push_back(run_of(one, backgrounds[workload], one_thread_fps[workload]));
  }
  return runs;
}

namespace {

// What the table shows of a value.
std::string shown(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.is_null() ? "-" : value.dump();
}

struct Column {
  std::string title, key;
  std::size_t width = 0;
};

// The choices in which runs differ, in the order in which they are written, and the queue.
std::vector<Column> choices_of(const Json& runs) {
  std::vector<Column> columns;
  const auto add = [&](const results::Field& field, bool always) {
    std::string title(field.heading.empty() ? field.key : field.heading);
    std::ranges::replace(title, '_', ' ');
    Column column{title, std::string(field.key), title.size()};
    bool differs = always;
    for (const Json& run : runs) {
      differs |= run[column.key] != runs[0][column.key];
      column.width = std::max(column.width, shown(run[column.key]).size());
    }
    if (differs) columns.push_back(column);
  };
  for (const auto& [key, value] : runs[0].items()) {
    const results::Field& field = *results::find(key);
    const bool line =
        key == "queue" || key == "threads";  // the name of a line and its first figure
    if (field.role == results::Role::choice && !line) add(field, false);
  }
  add(*results::find("queue"), true);
  return columns;
}

std::string number(const Json& value, int width, int digits, double scale = 1) {
  if (value.is_null()) return fmt::format("{:>{}}", "-", width);
  return fmt::format("{:>{}.{}f}", value.get<double>() * scale, width, digits);
}

std::string quartiles(const Json& run) {
  if (run["fps_lower_quartile"].is_null()) return "-";
  return fmt::format("{:.2f} to {:.2f}", run["fps_lower_quartile"].get<double>(),
                     run["fps_upper_quartile"].get<double>());
}

std::string trouble(const Json& run) {
  if (run["status"] == "ok") return {};
  return fmt::format("  {}: {}", run["status"].get<std::string>(),
                     run["message"].get<std::string>());
}

}  // namespace

std::string table(const nlohmann::ordered_json& runs) {
  const std::vector<Column> columns = choices_of(runs);
  std::string text;
  for (const Column& column : columns) {
    text += fmt::format("{:<{}}", column.title, column.width + 2);
  }
  // FPS with quartiles, Mrays/s, speed-up, ns per task in get and add, pops that failed per frame,
  // ms per frame and thread without work and at the barrier.
  text += fmt::format("{:>7}{:>9}  {:<17}{:>9}{:>9}{:>8}{:>8}{:>9}{:>9}{:>9}\n", "threads", "FPS",
                      "quartiles", "Mrays/s", "speed-up", "get ns", "add ns", "failed", "idle ms",
                      "barr. ms");
  const bool moves =
      std::ranges::any_of(runs, [](const Json& run) { return !run["animate"].is_null(); });
  if (moves) {
    text.pop_back();
    text += fmt::format("{:>10}{:>9}\n", "update ms", "rebuilt");
  }
  std::string last;
  unsigned lines = 0;  // in a row that differ in the threads only
  for (const auto& run : runs) {
    std::string choices;
    for (const Column& column : columns) {
      choices += fmt::format("{:<{}}", shown(run[column.key]), column.width + 2);
    }
    if (choices != last) {
      if (lines > 1) text += '\n';
      lines = 0;
    }
    ++lines;
    last = choices;
    text += choices + fmt::format("{:>7}", run["threads"].get<unsigned>()) +
            number(run["fps"], 9, 2) + "  " + fmt::format("{:<17}", quartiles(run)) +
            number(run["rays_per_second"], 9, 3, 1e-6) + number(run["speed_up"], 9, 2) +
            number(run["get_ns"], 8, 0) + number(run["add_ns"], 8, 0) +
            number(run["failed_gets_per_frame"], 9, 0) + number(run["idle_ms"], 9, 2) +
            number(run["barrier_wait_ms"], 9, 2) +
            (moves ? number(run["update_ms"], 10, 2) + number(run["share_rebuilt"], 9, 2) : "") +
            trouble(run) + '\n';
  }
  return text;
}

std::string csv(const nlohmann::ordered_json& runs) {
  std::string names, lines;
  for (const auto& run : runs) {
    std::string line;
    names.clear();
    for (const auto& [name, value] : run.items()) {
      if (name == "conditions" || value.is_structured()) continue;
      if (!names.empty()) line += ',';
      names += names.empty() ? name : "," + name;
      if (!value.is_null()) line += value.dump();
    }
    lines += line + '\n';
  }
  return names + '\n' + lines;
}

std::string note_on_turns(const QueueEntry& queue) {
  return fmt::format(
      "{} is for one {}: with more threads they take turns at it, by a mutex at each such end, and "
      "the figures are those of both",
      queue.name,
      !queue.claims.one_producer()   ? "consumer"
      : !queue.claims.one_consumer() ? "producer"
                                     : "producer and one consumer");
}

}  // namespace irt::frames
