/// The render threads' loop of renderer/engine/render_loop.hpp, compiled for virtual cores, with
/// recorded tasks instead of rays.
#pragma once

#include <cstdint>

#include "queues/work_queue.hpp"
#include "renderer/engine/activity.hpp"

namespace irt::many_core {

/// What the replayed code asks of the simulator; nothing of it takes simulated time but work.
class ReplayHost {
 public:
  ReplayHost() = default;
  ReplayHost(const ReplayHost&) = delete;
  ReplayHost& operator=(const ReplayHost&) = delete;
  virtual ~ReplayHost() = default;

  /// Works as long as GenPrimRays took, or Output.
  virtual void generate() = 0;
  virtual void output() = 0;
  virtual void trace(std::uint32_t task) = 0;
  virtual void shade(std::uint32_t task) = 0;
  /// Copies up to `room` pixels that `task` adds to, from the `from`th on; returns how many.
  virtual std::uint32_t pixels(std::uint32_t task, std::uint32_t from, std::uint32_t* to,
                               std::uint32_t room) = 0;
  virtual std::uint32_t first_child(std::uint32_t task) = 0;
  virtual std::uint32_t children(std::uint32_t task) = 0;
  /// Charges the time since the last call of this thread.
  virtual void charge(unsigned worker, Activity activity) = 0;
  virtual void frame_done() = 0;
};

/// What is replayed. `queue` may be of another module.
struct ReplayPlan {
  ReplayHost* host = nullptr;
  AnyWorkQueue<void*>* queue = nullptr;
  const char* frame_buffer = nullptr;  ///< a name of frame_buffers()
  std::uint32_t width = 0, height = 0;
  std::uint32_t tasks = 0, roots = 0;
  unsigned threads = 1, frames = 1;
  bool leave_when_empty = false;
};

}  // namespace irt::many_core

/// What the threads share, on virtual memory; and what each of them does.
extern "C" void* irt_replay_make(const irt::many_core::ReplayPlan* plan);
extern "C" void irt_replay_work(void* shared, unsigned worker);
