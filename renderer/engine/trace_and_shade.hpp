/// What every task system does with a task: trace its rays and hand the answers on.
#pragma once

#include <cstdint>
#include <span>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/engine/application.hpp"
#include "renderer/engine/engine.hpp"

namespace irt {

/// Room for the answers to one task's rays; one per worker.
struct Answers {
  explicit Answers(std::uint32_t rays) : hits(rays), occluded(rays) {}

  Hits hits;
  LaneArray<std::uint8_t> occluded;
};

/// Traces `task` and lets `application` make of the answers what it will. Calls `traced()` between
/// the two. What the application throws is passed on.
template <class Traced>
void trace_and_shade(const Task& task, const Accelerator& accelerator, Application& application,
                     Answers& answers, TaskSink& children, TraceProfile* profile, Traced traced) {
  if (task.kind == TaskKind::shadow) {
    const std::span occluded(answers.occluded.data(), task.rays.size);
    accelerator.any_hit(task.rays, occluded, profile);
    traced();
    application.on_occlusion(task, occluded, children);
  } else {
    accelerator.closest_hit(task.rays, answers.hits, profile);
    traced();
    application.on_hits(task, answers.hits, children);
  }
}

/// The same, counted in `stats`. One task of `profile_every` is profiled; 0: none. `traced` is told
/// the account that the time belongs to.
template <class Traced>
void trace_and_shade(const Task& task, const Accelerator& accelerator, Application& application,
                     Answers& answers, TaskSink& children, WorkerStats& stats,
                     std::uint32_t profile_every, Traced traced) {
  ++stats.tasks;
  stats.rays[static_cast<std::size_t>(task.kind)] += task.rays.size;
  const bool profiled = profile_every != 0 && stats.tasks % profile_every == 0;
  trace_and_shade(task, accelerator, application, answers, children,
                  profiled ? &stats.profile : nullptr,
                  [&] { traced(profiled ? stats.profiled_ns : stats.trace_ns); });
}

}  // namespace irt
