/// What the engine serves: it decides which rays a frame starts with and what their answers mean
/// (thesis 3.1: rendering is decoupled from the application logic).
#pragma once

#include <cstdint>
#include <span>

#include "renderer/engine/task.hpp"
#include "renderer/engine/task_pool.hpp"

namespace irt {

class Application {
 public:
  Application() = default;
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;
  virtual ~Application() = default;

  /// Makes the first tasks of a frame (GenPrimRays of Listing 3.4). Called by one thread, while the
  /// render threads wait.
  virtual void start_frame(TaskSink& tasks) = 0;

  /// Takes what the rays of a primary or specular task met first. Called by any number of render
  /// threads at once, each with a task of its own; may make new tasks.
  virtual void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) = 0;

  /// Takes which rays of a shadow task met anything: 1 or 0 per ray. Otherwise as `on_hits`.
  virtual void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                            TaskSink& tasks) = 0;

  /// Hands out the finished frame (Output of Listing 3.4). Called by one thread; not of a frame
  /// that was cancelled.
  virtual void finish_frame() {}
};

}  // namespace irt
