/// From samples to the figures that are reported.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/frames/sample.hpp"

namespace irt::frames {

/// What all runs of one workload have in common.
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct Background {
  WorkloadOptions workload;
  std::size_t triangles = 0;
  unsigned warmup = 0;
  std::optional<double> traverse_share{};  ///< see `traverse_share()`; null shares without it
  nlohmann::json conditions;
};

/// One object per workload, queue and number of threads, in the order of their first samples;
/// `backgrounds` are those of the workloads. Speeds are medians over all frames, with quartiles,
/// and with the 95 % interval of the mean of `fps_samples`, the medians of the repetitions;
/// `work_per_task_ns` is the mean time of tracing and shading a task, what is done between pop and
/// pushes; `speed_up` is against the workload's fastest run with one thread and null without one.
/// Times of the queue are per task, in medians, 99th percentiles and means, with the cost of the
/// clock taken off, and null where there is no queue.
nlohmann::ordered_json summarise(std::span<const Sample> samples,
                                 std::span<const Background> backgrounds);

/// The table that people read: one line per run, with a column for every choice that differs.
std::string table(const nlohmann::ordered_json& runs);

/// What to know of the figures of a queue at which threads take turns.
std::string note_on_turns(const QueueEntry& queue);

/// One line per run under a line of names: all fields but the conditions and lists.
std::string csv(const nlohmann::ordered_json& runs);

}  // namespace irt::frames
