/// A frame of the renderer as the tree of tasks that it is, with what each task costs: recorded on
/// one core, to be replayed on many that are not there.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "bench/frames/workload.hpp"

namespace irt::many_core {

/// One task. Children and contributions are ranges of `Recording`.
struct RecordedTask {
  TaskKind kind = TaskKind::primary;
  std::uint32_t rays = 0;
  float trace_ns = 0, shade_ns = 0;  ///< of this core, without adding to the frame buffer
  std::uint32_t first_child = 0, children = 0;
  std::uint32_t first_pixel = 0, pixels = 0;  ///< contributions that it adds
};

struct Recording {
  std::vector<RecordedTask> tasks;    ///< the first ones, then children in the order of parents
  std::uint32_t roots = 0;            ///< tasks that the frame starts with
  std::vector<std::uint32_t> pixels;  ///< of all contributions
  std::uint32_t width = 0, height = 0;
  double generate_ns = 0, output_ns = 0;  ///< GenPrimRays and Output of Listing 3.4
  double clock_ghz = 0;                   ///< of this core, under load
  unsigned repetitions = 0;
  double spread = 0;  ///< interquartile range over median of a frame's whole cost

  /// What one core needs for all tasks, queue and frame buffer left out.
  [[nodiscard]] double work_ns() const;
  [[nodiscard]] std::uint64_t rays() const;
};

/// Renders `workload` task by task, first come, first served, on the calling thread, `repetitions`
/// times; the cost of a task is the median, so that a lost core disturbs none. The clock's own cost
/// is taken off. If `cancel` becomes true the recording has no tasks.
Recording record(const frames::Workload& workload, unsigned repetitions,
                 const std::atomic<bool>& cancel);

}  // namespace irt::many_core
