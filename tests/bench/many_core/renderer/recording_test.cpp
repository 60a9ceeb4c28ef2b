#include "bench/many_core/renderer/recording.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "queues/registry.hpp"

namespace irt::many_core {
namespace {

frames::WorkloadOptions small() {
  frames::WorkloadOptions options;
  options.scene = "bunny";
  options.width = options.height = 64;
  options.task_size = 32;
  check(options);
  return options;
}

TEST(Recording, IsTheTreeThatTheEngineWorksThrough) {
  frames::Workload workload(small());
  const std::atomic<bool> go_on{false};
  const Recording recording = record(workload, 3, go_on);

  const QueueRegistry queues;
  const auto engine = workload.start_engine(workload.engine_options(1), queues.first());
  const FrameStats frame = engine->run(workload.application());
  EXPECT_EQ(recording.tasks.size(), frame.total().tasks);
  EXPECT_EQ(recording.rays(), frame.rays());

  // Every task but the first ones is the child of exactly one.
  ASSERT_GT(recording.roots, 0U);
  std::uint32_t next = recording.roots;
  for (const RecordedTask& task : recording.tasks) {
    EXPECT_EQ(task.first_child, next);
    next += task.children;
  }
  EXPECT_EQ(next, recording.tasks.size());
}

TEST(Recording, HasAContributionPerRayAndCosts) {
  const frames::Workload workload(small());
  const std::atomic<bool> go_on{false};
  const Recording recording = record(workload, 3, go_on);
  std::uint32_t next = 0;
  for (const RecordedTask& task : recording.tasks) {
    EXPECT_EQ(task.first_pixel, next);
    EXPECT_EQ(task.pixels, task.rays);
    EXPECT_GT(task.trace_ns, 0);
    next += task.pixels;
  }
  EXPECT_EQ(next, recording.pixels.size());
  EXPECT_LT(*std::ranges::max_element(recording.pixels), 64U * 64U);
  EXPECT_GT(recording.generate_ns, 0);
  EXPECT_GT(recording.clock_ghz, 0.1);
}

TEST(Recording, CanBeStopped) {
  const frames::Workload workload(small());
  const std::atomic<bool> stop{true};
  EXPECT_TRUE(record(workload, 3, stop).tasks.empty());
}

}  // namespace
}  // namespace irt::many_core
