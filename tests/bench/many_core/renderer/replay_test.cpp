#include <algorithm>
#include <gtest/gtest.h>
#include <map>

#include "bench/many_core/renderer/sweep.hpp"
#include "stress/virtual_cores/queue_modules.hpp"
#include "tests/bench/fields.hpp"

namespace irt::many_core {
namespace {

using Runs = std::vector<nlohmann::ordered_json>;

// A frame of `roots` tasks with two children each, all of `task_ns` of work.
Recording frame_of(std::uint32_t roots, float task_ns) {
  Recording recording;
  recording.width = recording.height = 64;
  recording.roots = roots;
  recording.clock_ghz = 1;
  for (std::uint32_t i = 0; i < 3 * roots; ++i) {
    RecordedTask task{.kind = TaskKind::primary, .rays = 4, .trace_ns = task_ns};
    task.first_child = i < roots ? roots + 2 * i : 3 * roots;
    task.children = i < roots ? 2 : 0;
    task.first_pixel = static_cast<std::uint32_t>(recording.pixels.size());
    task.pixels = 4;
    for (std::uint32_t k = 0; k < 4; ++k) recording.pixels.push_back((4 * i + k) % (64 * 64));
    recording.tasks.push_back(task);
  }
  return recording;
}

RendererSweep options_for(std::vector<std::string> queues, std::vector<unsigned> cores) {
  const virtual_cores::QueueModules known;
  std::vector<std::filesystem::path> modules;
  modules.reserve(queues.size());
  for (const std::string& queue : queues) modules.push_back(*known.find(queue));
  return {.queues = std::move(queues),
          .cores = std::move(cores),
          .modules = std::move(modules),
          .replay = {.replay_module = IRT_REPLAY_MODULE},
          .pace = {Pace::Kind::factor, 1},
          .seeds = 1};
}

Runs run(const Recording& recording, const RendererSweep& options,
         const char* machine = "xeon-7400") {
  const std::atomic<bool> go_on{false};
  Runs runs = sweep_renderer(load_profile(machine), recording, options, go_on, nullptr);
  for (const auto& each : runs) EXPECT_EQ(each["status"], "ok") << each.dump();
  return runs;
}

double fps(const Runs& runs, const std::string& queue, unsigned threads) {
  const auto found = std::ranges::find_if(
      runs, [&](const auto& each) { return each["queue"] == queue && each["threads"] == threads; });
  return found == runs.end() ? 0 : found->value("fps", 0.0);
}

TEST(Replay, OneCoreTakesItsWorkAndLittleMore) {
  const Recording recording = frame_of(100, 50e3F);
  const Runs runs = run(recording, options_for({"local", "lfree", "lock"}, {1}));
  ASSERT_EQ(runs.size(), 3U);
  for (const auto& each : runs) {
    const double frame_ns = 1e9 / each["fps"].get<double>();
    EXPECT_GE(frame_ns, recording.work_ns() * 0.9999);
    EXPECT_LE(frame_ns, recording.work_ns() * 1.05);
    EXPECT_NEAR(each["speed_up"].get<double>(), 1, 0.05);
  }
}

TEST(Replay, LongTasksScaleWhateverTheQueue) {
  const Recording recording = frame_of(240, 200e3F);
  const Runs runs = run(recording, options_for({"local", "lfree", "lock"}, {1, 6}));
  for (const char* queue : {"local", "lfree", "lock"}) {
    const double speed_up = fps(runs, queue, 6) / fps(runs, queue, 1);
    EXPECT_GT(speed_up, 5.4) << queue;
    EXPECT_LE(speed_up, 6.05) << queue;
  }
}

TEST(Replay, ShortTasksTellQueuesApart) {
  // Half a microsecond between operations, far less than 24 cores may have of one queue.
  const Recording recording = frame_of(600, 500);
  const Runs runs = run(recording, options_for({"local", "lfree", "lock"}, {24}));
  EXPECT_GT(fps(runs, "local", 24), 1.5 * fps(runs, "lfree", 24));
  EXPECT_GT(fps(runs, "local", 24), 1.5 * fps(runs, "lock", 24));
}

TEST(Replay, OneLockAroundTheFrameBufferHoldsEverybodyUp) {
  const Recording recording = frame_of(600, 2000);
  RendererSweep options = options_for({"local"}, {24});
  const double free = fps(run(recording, options), "local", 24);
  options.replay.frame_buffer = "spinlock";
  EXPECT_GT(free, 1.5 * fps(run(recording, options), "local", 24));
}

TEST(Replay, ThreadsThatLeaveWhenEmptyFinishTheFrame) {
  RendererSweep options = options_for({"local", "lfree", "lock", "mutex"}, {4});
  options.replay.leave_when_empty = true;
  EXPECT_EQ(run(frame_of(50, 20e3F), options).size(), 4U);
}

// Where 24 cores want one place about as many swaps fail as succeed: for two of these more do.
TEST(Replay, FailedSwapsStandAgainstThoseThatSucceeded) {
  const Runs runs = run(frame_of(100, 100), options_for({"lfree", "lock", "mutex"}, {1, 24}),
                        "granite-rapids-96");
  for (const auto& each : runs) {
    const double failures = each["cas_failures_per_success"];
    if (each["threads"] == 1) {
      EXPECT_EQ(failures, 0) << each.dump();
    } else {
      EXPECT_GT(failures, 0.5) << each.dump();
      EXPECT_LT(failures, 3) << each.dump();
    }
  }
}

TEST(Replay, WritesTheFieldsOfItsTool) {
  const Recording recording = frame_of(10, 1000);
  Runs runs = run(recording, options_for({"lfree"}, {2}));
  ASSERT_EQ(runs.size(), 1U);
  describe(runs[0], {}, Placement::close, recording);
  EXPECT_EQ(keys_of(runs[0]), [] {
    auto keys = fields_by(results::by_replay);
    keys.erase("conditions");  // the command adds them
    return keys;
  }());
}

TEST(Replay, SameSeedSameResult) {
  const Recording recording = frame_of(60, 3000);
  const RendererSweep options = options_for({"lfree", "lock"}, {8});
  EXPECT_EQ(run(recording, options), run(recording, options));
}

TEST(Replay, AStoppedSweepKeepsWhatItHas) {
  const std::atomic<bool> stop{true};
  EXPECT_TRUE(sweep_renderer(load_profile("xeon-7400"), frame_of(10, 1000),
                             options_for({"lock"}, {2}), stop, nullptr)
                  .empty());
}

TEST(Replay, APaceIsWhatItSays) {
  const Recording recording = frame_of(100, 50e3F);
  Profile machine = load_profile("xeon-7400");
  EXPECT_DOUBLE_EQ(scale_of({Pace::Kind::clock}, recording, machine), 1 / machine.clock_ghz);
  EXPECT_DOUBLE_EQ(scale_of({Pace::Kind::factor, 3}, recording, machine), 3);
  EXPECT_NEAR(scale_of({Pace::Kind::mean_task, 100e3}, recording, machine), 2, 1e-9);
  // 300 tasks of 50 us are 15 ms: for ten frames a second they have to take 100.
  EXPECT_NEAR(scale_of({Pace::Kind::one_core, 10}, recording, machine), 100.0 / 15, 1e-9);
}

}  // namespace
}  // namespace irt::many_core
