// Queues of a round that take turns.
#include "bench/contention/turns.hpp"

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

namespace irt::contention {
namespace {

std::string plugin(const char* name) {
  return std::string(IRT_TEST_PLUGINS) + "/" + name + ".so";
}

Job job_for(const char* queue) {
  Job job;
  job.queue = queue;
  job.scenario = "pairs";
  job.capacity = 1024;
  job.seconds = 0.1;
  job.turns = turns_in(job.seconds, {});
  job.warmup_seconds = 0.06;
  job.patience_seconds = 1;
  if (std::string(queue) != "mutex" && std::string(queue) != "lock") job.plugins = {plugin(queue)};
  return job;
}

std::map<std::string, Sample> measured(const std::vector<Job>& jobs,
                                       std::atomic<bool>* cancel_at_first = nullptr) {
  std::atomic<bool> cancel{false};
  std::map<std::string, Sample> samples;
  const auto keep = [&](std::size_t i, const Sample& sample) {
    EXPECT_FALSE(samples.contains(jobs[i].queue));
    samples[jobs[i].queue] = sample;
    if (cancel_at_first != nullptr) *cancel_at_first = true;
  };
  measure_in_turns(IRT_CONTENTION, jobs, 1, keep, cancel_at_first ? *cancel_at_first : cancel);
  return samples;
}

TEST(Turns, MakeUpTheInterval) {
  EXPECT_EQ(turns_in(0.001, {}), 1U);
  EXPECT_EQ(turns_in(0.2, {}), 25U);
}

TEST(Turns, AreLongerWhereThreadsShareProcessors) {
  EXPECT_EQ(turn_of(4, 4).seconds, Turn().seconds);
  EXPECT_GT(turn_of(5, 4).seconds, 4 * Turn().seconds);
  EXPECT_GT(turn_of(5, 4).settling_seconds, Turn().settling_seconds);
  EXPECT_GT(turn_of(9, 4).seconds, turn_of(5, 4).seconds);
}

TEST(Turns, NeverOverlapAndPausesDoNotCount) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Job> jobs{job_for("mutex"), job_for("lock"), job_for("twin-a")};
  const auto samples = measured(jobs);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  ASSERT_EQ(samples.size(), 3U);
  double together = 0;
  for (const auto& [queue, sample] : samples) {
    EXPECT_EQ(sample.status, "ok") << queue << ": " << sample.message;
    EXPECT_GE(sample.seconds, jobs[0].seconds) << queue;
    EXPECT_GT(sample.operations(), 0U) << queue;
    EXPECT_LE(sample.cpu_seconds, sample.seconds * 1.1) << queue;
    together += sample.seconds + jobs[0].turns * jobs[0].settling_seconds;
  }
  EXPECT_LE(together, taken.count());
}

TEST(Turns, OneThatDiesOrHangsLeavesTheOthersTheirs) {
  const auto samples = measured({job_for("crashing"), job_for("mutex"), job_for("hanging"),
                                 job_for("throwing"), job_for("lock")});
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_EQ(samples.at("crashing").status, "crashed");
  EXPECT_EQ(samples.at("hanging").status, "hung");
  EXPECT_EQ(samples.at("throwing").status, "failed");
  for (const char* queue : {"mutex", "lock"}) {
    EXPECT_EQ(samples.at(queue).status, "ok") << samples.at(queue).message;
    EXPECT_GE(samples.at(queue).seconds, 0.1);
  }
}

TEST(Turns, AreOverWhenInterrupted) {
  std::atomic<bool> cancel{false};
  const auto samples = measured({job_for("crashing"), job_for("mutex"), job_for("lock")}, &cancel);
  EXPECT_EQ(samples.size(), 1U);
}

}  // namespace
}  // namespace irt::contention
