/// Who runs the tasks of a frame: a work queue and render threads, or the library of somebody else.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "renderer/engine/engine.hpp"

namespace irt {

/// A task system by name, as the tools see it.
struct TaskSystemEntry {
  std::string_view name;
  std::string_view summary;
  /// Whether it takes the queue, the termination policy and the pinning that it is given. Others
  /// have their own and ignore them.
  bool uses_queue;
  /// As `make_engine`.
  std::unique_ptr<Engine> (*make)(const EngineOptions& options, const QueueEntry& queue,
                                  const Accelerator& accelerator);
};

/// All task systems that this build has, the default first.
std::span<const TaskSystemEntry> task_systems();

}  // namespace irt
