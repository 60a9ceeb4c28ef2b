#include "renderer/engine/engine.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <thread>

#include "renderer/engine/placement.hpp"
#include "tests/renderer/engine/brute_force.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/engine/tree_count.hpp"

namespace irt {
namespace {

constexpr QueueEntry own = queue_entry<OwnQueues>("own");
constexpr QueueEntry tiny = queue_entry<TinyQueue>("tiny");
constexpr QueueEntry single = queue_entry<SingleQueue>("single");
constexpr QueueEntry lossy = queue_entry<LossyQueue>("lossy");
constexpr QueueEntry doubling = queue_entry<DoublingQueue>("doubling");

struct EngineTest : testing::Test {
  Mesh empty;
  BruteForce accelerator{empty};

  [[nodiscard]] EngineOptions options(unsigned threads, Termination termination) const {
    return {
        .threads = threads, .rays_per_task = 64, .termination = termination, .queue_capacity = 512};
  }
};

TEST_F(EngineTest, EveryTaskIsTracedOnceAndComesBackToThePool) {
  for (const QueueEntry* queue : {&plain_queue, &own, &tiny, &single}) {
    for (const TerminationEntry& termination : terminations()) {
      for (const unsigned threads : {1u, 2u, 3u, 8u, 16u}) {
        SCOPED_TRACE(std::string(queue->name) + " " + std::string(termination.name) + " " +
                     std::to_string(threads));
        auto engine = make_engine(options(threads, termination.policy), *queue, accelerator);
        TreeCount application(60, 5);
        for (int frame = 0; frame < 5; ++frame) {
          const FrameStats stats = engine->run(application);
          ASSERT_EQ(application.count, application.rays());
          EXPECT_EQ(stats.rays(), application.rays());
          EXPECT_EQ(stats.total().tasks, 60u * 11);
          EXPECT_EQ(stats.total().added, 60u * 10);
          EXPECT_EQ(stats.lost + stats.doubled, 0u);
          EXPECT_EQ(engine->tasks_in_use(), 0u);
        }
        EXPECT_EQ(application.frames, 5);
        EXPECT_GE(engine->tasks_allocated(), 60u);
      }
    }
  }
}

TEST_F(EngineTest, MemoryStopsGrowing) {
  auto engine = make_engine(options(4, Termination::outstanding_count), plain_queue, accelerator);
  TreeCount application(60, 5);
  for (int frame = 0; frame < 200; ++frame) engine->run(application);
  // At most 60 * 11 tasks exist in a frame; level lists leave each of 4 workers at most that many.
  EXPECT_LE(engine->tasks_allocated(), 4u * 60 * 11);
}

TEST_F(EngineTest, AFrameWithoutTasksEnds) {
  for (const TerminationEntry& termination : terminations()) {
    auto engine = make_engine(options(3, termination.policy), plain_queue, accelerator);
    TreeCount application(0, 5);
    EXPECT_EQ(engine->run(application).rays(), 0u);
    EXPECT_EQ(application.frames, 1);
  }
}

TEST_F(EngineTest, ABoundedQueueOverflowsToTheWorker) {
  auto engine = make_engine(options(2, Termination::outstanding_count), tiny, accelerator);
  TreeCount application(60, 5);
  EXPECT_GT(engine->run(application).total().overflowed, 0u);
}

TEST_F(EngineTest, ALostTaskIsReportedNotWaitedFor) {
  for (const TerminationEntry& termination : terminations()) {
    auto engine = make_engine(options(3, termination.policy), lossy, accelerator);
    TreeCount application(20, 2);
    EXPECT_EQ(engine->run(application).lost, 1u);
    EXPECT_LT(application.count, application.rays());
    const FrameStats next = engine->run(application);
    EXPECT_EQ(next.lost, 0u);
    EXPECT_EQ(application.count, application.rays());
  }
}

// A first task that takes longer than lost ones are waited for, and two children that end when both
// are worked on.
class SlowStart final : public Application {
 public:
  void start_frame(TaskSink& tasks) override { add(tasks, 0); }
  void on_hits(const Task& task, const Hits& /*hits*/, TaskSink& tasks) override {
    if (!slow) return;
    if (task.depth == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2600));
      add(tasks, 1);
      add(tasks, 1);
      return;
    }
    ++at_work;
    for (int i = 0; i < 5000 && at_work < 2; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void on_occlusion(const Task& /*task*/, std::span<const std::uint8_t> /*occluded*/,
                    TaskSink& /*tasks*/) override {}
  void finish_frame() override {}

  bool slow = false;
  std::atomic<int> at_work{0};

 private:
  static void add(TaskSink& tasks, std::uint32_t depth) {
    tasks.add(TaskKind::primary, depth).rays.add({{}, {1, 0, 0}}, {1, 1, 1}, 0);
  }
};

TEST_F(EngineTest, ALongTaskIsNoLostOne) {
  auto engine = make_engine(options(2, Termination::outstanding_count), plain_queue, accelerator);
  SlowStart application;
  engine->run(application);
  application.slow = true;
  const auto begin = std::chrono::steady_clock::now();
  engine->run(application);
  EXPECT_EQ(application.at_work, 2);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(2600 + 4000))
      << "the other thread has left";
}

TEST_F(EngineTest, ADoubledTaskIsReportedAndTracedTwice) {
  for (const TerminationEntry& termination : terminations()) {
    for (const unsigned threads : {1u, 4u}) {
      auto engine = make_engine(options(threads, termination.policy), doubling, accelerator);
      TreeCount application(20, 2);
      const FrameStats stats = engine->run(application);
      EXPECT_EQ(stats.doubled, 1u);
      EXPECT_EQ(stats.lost, 0u);
      EXPECT_GT(application.count, application.rays());
      engine->run(application);
      EXPECT_EQ(application.count, application.rays());
    }
  }
}

TEST_F(EngineTest, ACancelledFrameIsThrownAway) {
  std::atomic<bool> cancel{true};
  EngineOptions wanted = options(3, Termination::outstanding_count);
  wanted.cancel = &cancel;
  auto engine = make_engine(wanted, plain_queue, accelerator);
  TreeCount application(60, 5);
  EXPECT_TRUE(engine->run(application).cancelled);
  EXPECT_EQ(application.count, 0u);
  cancel = false;
  EXPECT_FALSE(engine->run(application).cancelled);
  EXPECT_EQ(application.count, application.rays());
}

TEST_F(EngineTest, TimesAddUpToTheFrame) {
  for (const bool measure : {true, false}) {
    EngineOptions wanted = options(2, Termination::outstanding_count);
    wanted.measure = measure;
    wanted.profile_every = 7;
    auto engine = make_engine(wanted, plain_queue, accelerator);
    TreeCount application(60, 5);
    const FrameStats stats = engine->run(application);
    EXPECT_GT(stats.render_s, 0);
    for (const WorkerStats& worker : stats.workers) {
      const auto accounted = worker.busy_ns() + worker.idle_ns + worker.barrier_ns;
      EXPECT_LE(static_cast<double>(accounted), stats.render_s * 1e9);
    }
    EXPECT_EQ(stats.total().busy_ns() > 0, measure);
    EXPECT_EQ(stats.total().profile.intersect_ns > 0, measure);
    EXPECT_GE(stats.imbalance(), 1);
  }
}

TEST_F(EngineTest, PinningIsReported) {
  EngineOptions wanted = options(4, Termination::outstanding_count);
  EXPECT_FALSE(make_engine(wanted, plain_queue, accelerator)->pinned());
  wanted.pin = true;
  EXPECT_EQ(make_engine(wanted, plain_queue, accelerator)->pinned(), can_pin());
}

}  // namespace
}  // namespace irt
