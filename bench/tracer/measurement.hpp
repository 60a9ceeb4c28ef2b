/// Timing several contestants in turn, and whether they agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/tracer/contestant.hpp"
#include "bench/tracer/scene_rays.hpp"
#include "renderer/bvh/executor.hpp"

namespace irt::tracer {

/// Half the range of the middle half of `values`, in per cent of their median.
double spread(std::vector<double> values);

/// How long the tasks of several rounds took.
///
/// Every task is timed on its own and the median is taken task by task: what another program or an
/// interrupt takes of the machine falls on some tasks of some rounds and drops out.
class TaskTimes {
 public:
  /// A round of `tasks` tasks; task i writes its ticks to the i-th element.
  std::span<std::uint64_t> add_round(std::size_t tasks);

  /// The sum of the tasks' medians in milliseconds of one thread.
  [[nodiscard]] double busy_ms() const;
  /// The sum of each round, disturbances included.
  [[nodiscard]] std::vector<double> rounds_ms() const;

 private:
  std::vector<std::vector<std::uint64_t>> rounds_;
};

/// What becomes of a batch.
struct Answers {
  explicit Answers(std::uint32_t lanes) : hits(lanes), occluded(lanes) {}
  Hits hits;
  LaneArray<std::uint8_t> occluded;
};

/// Traces every batch once on the executor's threads.
void trace_all(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
               std::span<Answers> answers, Executor& executor);

/// The same for the time it takes: a round of `times`. Each batch is copied to the same place
/// before its clock starts and the answers stay where they are: in the renderer, too, rays are
/// traced as soon as they are made, and memory would otherwise take half of the time.
void trace_timed(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
                 Executor& executor, TaskTimes& times);

/// How the answers of a contestant differ from those of another.
struct Disagreement {
  std::uint64_t rays = 0;
  std::uint64_t bits = 0;       ///< not the same triangle and bits of t, u and v
  std::uint64_t missed = 0;     ///< hit by one and not by the other
  std::uint64_t elsewhere = 0;  ///< another triangle, and not at the same distance (1e-4 relative)
};

Disagreement compare(RayKind kind, std::span<const Rays> batches,
                     std::span<const Answers> reference, std::span<const Answers> answers);

}  // namespace irt::tracer
