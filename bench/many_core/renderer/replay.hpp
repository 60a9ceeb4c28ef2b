/// The renderer on a machine that is not there: a recorded frame, the real queue code and the real
/// frame buffer code on virtual cores, under the coherence cost model.
///
/// The loop of the render threads is that of the engine (renderer/engine/render_loop.hpp). Work
/// that touches nothing shared (tracing, shading) takes the recorded time, multiplied by `scale`.
///
/// Contributions to the frame buffer overlap as measured (replay.cpp), but for those behind a lock.
///
/// What the replayed code asks of the simulator it asks through a table of virtual functions, whose
/// lines cost as any others. Which entries share a line, and so where the linker has put the table,
/// moves the figures of several cores about as another seed does: only builds in which it lies
/// alike give the same to the bit.
///
/// Not modelled: the rays of a task, which travel from the core that made it to the one that takes
/// it; what cores take from each other in memory bandwidth and shared cache; a clock that falls
/// when more cores are busy.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/many_core/machine/machine.hpp"
#include "bench/many_core/machine/placement.hpp"
#include "bench/many_core/renderer/recording.hpp"

namespace irt::many_core {

struct ReplayOptions {
  std::filesystem::path queue_module{};   ///< a queue compiled for virtual cores
  std::filesystem::path replay_module{};  ///< replay_module.cpp, compiled so
  std::string frame_buffer = "private-sums";
  unsigned threads = 1;
  unsigned frames = 1;  ///< measured, after one that is not
  Placement placement = Placement::close;
  bool leave_when_empty = false;
  std::size_t capacity = 1U << 16U;
  double scale = 1;  ///< simulated work per recorded work
};

/// The factor from recorded work to work on `machine`: by their clocks alone.
double clock_scale(const Recording& recording, const Profile& machine);

/// Replays and returns what came out, as one object: status ("ok", "hung", "failed"), message,
/// fps, frame_seconds (each), tasks_per_frame, get_ns and add_ns (means per operation), shares of
/// all threads' time: share_get, share_add, share_idle, share_trace, share_shade, share_barrier,
/// share_serial; transfers_per_task, cas_failures_per_success, waiting (by cause: share of all
/// threads' time, the first frame included), sleeps_per_task. Call it once per process.
nlohmann::json replay(const Profile& profile, const Recording& recording,
                      const ReplayOptions& options, std::uint64_t seed);

}  // namespace irt::many_core
