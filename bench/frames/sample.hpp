/// One repetition: some frames rendered in a row with one queue and so many threads.
#pragma once

#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/frames/workload.hpp"

namespace irt::frames {

/// What was measured. Everything but `seconds` is summed over the frames; times of workers over
/// frames and workers.
struct Sample {
  unsigned workload = 0;  ///< which of several that are compared
  std::string queue;      ///< "-" where the task system needs none
  unsigned threads = 0;
  unsigned repetition = 0;
  std::string status = "ok";    ///< ok, hung, crashed or failed
  std::string message;          ///< of any other status: one line
  std::vector<double> seconds;  ///< T.Exec of each frame
  double pose_s = 0, update_s = 0, generate_s = 0, render_s = 0, output_s = 0;
  double barrier_s = 0, idle_s = 0;
  double trace_s = 0, shade_s = 0, get_s = 0, add_s = 0;
  double imbalance = 0;        ///< sum over frames; see FrameStats
  std::uint64_t rebuilds = 0;  ///< of the structure over a scene that moves
  std::uint64_t rays = 0, tasks = 0, added = 0, failed_gets = 0, overflowed = 0;
  std::uint64_t lost = 0, doubled = 0;
  std::vector<std::uint64_t> gets, adds;  ///< see TimeHistogram, without the zeros at the end
  bool pinned = false;
  bool same_image = true;  ///< every frame had the same hash
  std::string image_hash;  ///< of the last frame; where the scene moves, of all frames

  void add(const FrameStats& frame, const Motion& motion = {});
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Sample, workload, queue, threads, repetition, status, message,
                                   seconds, pose_s, update_s, rebuilds, generate_s, render_s,
                                   output_s, barrier_s, idle_s, trace_s, shade_s, get_s, add_s,
                                   imbalance, rays, tasks, added, failed_gets, overflowed, lost,
                                   doubled, gets, adds, pinned, same_image, image_hash)

/// Says what is in a journal of samples.
inline constexpr const char* journal_format = "irt-frames 3";

struct SampleOptions {
  unsigned threads = 1;
  unsigned warmup = 1;  ///< frames that are rendered first and not counted
  unsigned frames = 1;
  bool measure = true;        ///< see EngineOptions
  TraceLog* trace = nullptr;  ///< likewise; of the frames that count
};

/// Adds `counts` to `sum`, which grows as far as there are counts.
void add_counts(std::vector<std::uint64_t>& sum, std::span<const std::uint64_t> counts);

/// Renders with a new engine; a scene that moves starts from its first frame. If `cancel` becomes
/// true the frames finished so far are returned, perhaps none. After each frame `on_frame` hears
/// whether it counts. Throws UsageError if the threads cannot be started.
Sample take_sample(Workload& workload, const QueueEntry& queue, const SampleOptions& options,
                   const std::atomic<bool>& cancel,
                   const std::function<void(bool)>& on_frame = nullptr);

/// The share of traversal in the time of tracing, the rest being intersection; taken in a frame of
/// its own whose speed does not count. Nothing where `cancel` ended that frame.
std::optional<double> traverse_share(Workload& workload, const QueueEntry& queue, unsigned threads,
                                     const std::atomic<bool>& cancel);

}  // namespace irt::frames
