#include "renderer/engine/task_systems.hpp"

#include <gtest/gtest.h>
#include <set>
#include <string>

#include "tests/renderer/engine/brute_force.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/engine/tree_count.hpp"

namespace irt {
namespace {

struct TaskSystems : testing::Test {
  Mesh empty;
  BruteForce accelerator{empty};

  // Calls `test(entry)` for each, the queue-driven one included: all keep the same promises.
  template <class Test>
  void for_each(Test test) {
    for (const TaskSystemEntry& entry : task_systems()) {
      SCOPED_TRACE(entry.name);
      test(entry);
    }
  }
};

TEST_F(TaskSystems, EveryTaskIsTracedOnceAndComesBackToThePool) {
  for_each([&](const TaskSystemEntry& entry) {
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
      const auto engine =
          entry.make({.threads = threads, .rays_per_task = 64}, plain_queue, accelerator);
      TreeCount application(60, 5);
      for (int frame = 0; frame < 5; ++frame) {
        const FrameStats stats = engine->run(application);
        ASSERT_EQ(application.count, application.rays());
        EXPECT_EQ(stats.rays(), application.rays());
        EXPECT_EQ(stats.total().tasks, 60u * 11);
        EXPECT_EQ(stats.total().added, 60u * 10);
        EXPECT_EQ(stats.lost + stats.doubled, 0u);
        EXPECT_EQ(engine->tasks_in_use(), 0u);
        EXPECT_EQ(stats.workers.size(), threads);
      }
      EXPECT_EQ(application.frames, 5);
    }
  });
}

TEST_F(TaskSystems, ALongLineOfDescendantsNeedsNoDeepStack) {
  for_each([&](const TaskSystemEntry& entry) {
    const auto engine = entry.make({.threads = 2, .rays_per_task = 16}, plain_queue, accelerator);
    TreeCount application(2, 30'000);
    engine->run(application);
    EXPECT_EQ(application.count, application.rays());
  });
}

TEST_F(TaskSystems, WhatTheApplicationThrowsArrivesAndTheEngineGoesOn) {
  for_each([&](const TaskSystemEntry& entry) {
    const auto engine = entry.make({.threads = 3, .rays_per_task = 64}, plain_queue, accelerator);
    TreeCount application(60, 5);
    application.throw_at = 100;
    EXPECT_THROW(engine->run(application), std::runtime_error);
    EXPECT_EQ(engine->tasks_in_use(), 0u);
    application.throw_at = 0;
    engine->run(application);
    EXPECT_EQ(application.count, application.rays());
  });
}

TEST_F(TaskSystems, ACancelledFrameIsThrownAway) {
  for_each([&](const TaskSystemEntry& entry) {
    std::atomic<bool> cancel{true};
    const auto engine = entry.make({.threads = 3, .rays_per_task = 64, .cancel = &cancel},
                                   plain_queue, accelerator);
    TreeCount application(60, 5);
    EXPECT_TRUE(engine->run(application).cancelled);
    EXPECT_EQ(application.count, 0u);
  });
}

TEST_F(TaskSystems, TimesAddUpToTheFrame) {
  for_each([&](const TaskSystemEntry& entry) {
    for (const bool measure : {true, false}) {
      const auto engine =
          entry.make({.threads = 2, .rays_per_task = 64, .measure = measure, .profile_every = 7},
                     plain_queue, accelerator);
      TreeCount application(60, 5);
      const FrameStats stats = engine->run(application);
      for (const WorkerStats& worker : stats.workers) {
        const auto accounted = worker.busy_ns() + worker.idle_ns + worker.barrier_ns;
        EXPECT_LE(static_cast<double>(accounted), stats.render_s * 1e9);
      }
      EXPECT_EQ(stats.total().busy_ns() > 0, measure);
      EXPECT_EQ(stats.total().profile.intersect_ns > 0, measure);
    }
  });
}

}  // namespace
}  // namespace irt
