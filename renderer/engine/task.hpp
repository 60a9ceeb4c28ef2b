/// What travels through the queue: a batch of rays, all of one kind.
#pragma once

#include <atomic>
#include <cstdint>

#include "renderer/tracing/rays.hpp"

namespace irt {

/// Shadow tasks ask whether anything is met, the others what is met first.
enum class TaskKind : std::uint8_t { primary, shadow, specular };

inline constexpr std::size_t task_kinds = 3;

struct Task {
  /// `memory`, for the rays, outlives the task.
  explicit Task(std::uint32_t capacity,
                std::pmr::memory_resource& memory = *std::pmr::new_delete_resource())
      : rays(capacity, memory) {}

  TaskKind kind = TaskKind::primary;
  std::uint32_t depth = 0;   ///< bounces since the primary ray
  std::uint32_t sample = 0;  ///< which sample of their pixels the rays belong to
  Rays rays;

  /// True from the moment the task is handed to the queue until it is taken. A task that is taken
  /// twice is thereby told from one that is taken once.
  std::atomic<bool> queued{false};
};

}  // namespace irt
