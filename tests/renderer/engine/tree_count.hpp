/// An application whose rays can be counted.
#pragma once

#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <stdexcept>

#include "renderer/engine/application.hpp"

namespace irt {

/// Counts every ray of a tree: task `i` of the first ones has i + 1 rays; every ray at a depth
/// below `depth` makes one shadow and one specular ray.
class TreeCount final : public Application {
 public:
  TreeCount(std::uint32_t roots, std::uint32_t max_depth) : roots_(roots), depth_(max_depth) {}

  void start_frame(TaskSink& tasks) override {
    count = 0;
    for (std::uint32_t i = 0; i < roots_; ++i) {
      Task& task = tasks.add(TaskKind::primary, 0);
      for (std::uint32_t k = 0; k <= i; ++k) task.rays.add({{}, {1, 0, 0}}, {1, 1, 1}, i);
    }
    tasks.add(TaskKind::primary, 0);  // stays empty: dropped
  }
  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) override {
    EXPECT_NE(task.kind, TaskKind::shadow);
    EXPECT_GT(task.rays.size, 0u);
    EXPECT_EQ(hits.triangle[task.rays.size - 1], no_triangle);
    count += task.rays.size;
    if (throw_at != 0 && count >= throw_at) throw std::runtime_error("enough");
    if (task.depth == depth_) return;
    Task& shadow = tasks.add(TaskKind::shadow, task.depth);
    Task& specular = tasks.add(TaskKind::specular, task.depth + 1);
    tasks.add(TaskKind::specular, 0);  // stays empty: dropped
    for (std::uint32_t i = 0; i < task.rays.size; ++i) {
      shadow.rays.add(task.rays.ray(i), {}, task.rays.pixel[i]);
      specular.rays.add(task.rays.ray(i), {}, task.rays.pixel[i]);
    }
  }
  void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                    TaskSink& /*tasks*/) override {
    EXPECT_EQ(task.kind, TaskKind::shadow);
    EXPECT_EQ(occluded.size(), task.rays.size);
    count += task.rays.size;
  }
  void finish_frame() override { ++frames; }

  [[nodiscard]] std::uint64_t rays() const {
    return std::uint64_t{roots_} * (roots_ + 1) / 2 * (2 * depth_ + 1);
  }

  std::atomic<std::uint64_t> count{0};
  std::uint64_t throw_at = 0;
  int frames = 0;

 private:
  std::uint32_t roots_, depth_;
};

}  // namespace irt
