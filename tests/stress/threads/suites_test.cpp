// Every suite must find the defect it is for, and leave a healthy queue alone.
#include "stress/threads/suites.hpp"

#include <gtest/gtest.h>

#include "broken_queues.hpp"
#include "fenced_ring.hpp"
#include "stress/mutants/recycled.hpp"
#include "stress/mutants/rings.hpp"
#include "stress/threads/child.hpp"
#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

using Suite = std::function<void(const Assignment&, Messenger&)>;

Result run(const QueueEntry& entry, double seconds, const Suite& suite) {
  static const ClockQuality clock = calibrate();
  const Assignment assignment{entry, clock, seconds, 1, "repeat"};
  Result result;
  result.queue = entry.name;
  run_in_child(
      result, seconds, 30, [&](Messenger& messenger) { suite(assignment, messenger); },
      [](std::uint64_t) {});
  return result;
}

Result run_on(const QueueEntry& entry, std::string_view scenario, double seconds = 0.5) {
  return run(entry, seconds, [&](const Assignment& a, Messenger& m) {
    run_scenario(a, *find_scenario(scenario), m);
  });
}

std::string claim_of(const Result& result) {
  return result.findings.empty() ? "nothing" : result.findings[0].claim;
}

TEST(ScenarioSuite, LeavesAHealthyQueueAlone) {
  for (const Scenario& scenario : scenarios()) {
    const Result result = run_on(broken_entry<Defect::none>(), scenario.name, 0.1);
    EXPECT_TRUE(result.findings.empty()) << scenario.name << ": " << claim_of(result) << "\n"
                                         << result.findings[0].evidence;
    EXPECT_GT(result.operations, 0U) << scenario.name;
  }
}

TEST(ScenarioSuite, FindsALostElement) {
  EXPECT_EQ(claim_of(run_on(broken_entry<Defect::loses>(), "mpmc")), "no element is lost");
}

TEST(ScenarioSuite, FindsADoubledElement) {
  EXPECT_EQ(claim_of(run_on(broken_entry<Defect::doubles>(), "mpmc")), "every element leaves once");
}

TEST(ScenarioSuite, FindsAWrongOrder) {
  const Result result = run_on(broken_entry<Defect::reorders>(), "bursts");
  EXPECT_EQ(claim_of(result), "order of elements");
  EXPECT_NE(result.findings[0].evidence.find('|'), std::string::npos) << "draws the operations";
  EXPECT_NE(result.findings[0].evidence.find("in round"), std::string::npos);
}

TEST(ScenarioSuite, FindsAFalseEmpty) {
  EXPECT_EQ(claim_of(run_on(broken_entry<Defect::lies_empty>(), "roles")), "empty only when empty");
}

TEST(ScenarioSuite, ACrashIsAFindingWithAStack) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "sanitizers report crashes themselves";
  const Result result = run_on(broken_entry<Defect::crashes>(), "mpmc");
  EXPECT_EQ(claim_of(result), "does not crash (Segmentation fault)");
  EXPECT_NE(result.findings[0].evidence.find("push"), std::string::npos)
      << result.findings[0].evidence;
}

TEST(ScenarioSuite, AHangIsAFindingWithStacks) {
  const Result result = run_on(broken_entry<Defect::hangs>(), "mpmc");
  EXPECT_EQ(claim_of(result).substr(0, 13), "does not hang") << claim_of(result);
  EXPECT_NE(result.findings[0].evidence.find("in pop"), std::string::npos)
      << result.findings[0].evidence;
}

// The limit of ThreadSanitizer that the report must name, and no more than that.
TEST(SecondLook, ARaceThatFencesExplainIsALimit) {
  if (sanitizer != Sanitizer::thread) GTEST_SKIP() << "the other builds do not look at races";
  const Result result = run_on(queue_entry<Fenced<false>::Queue>("fenced"), "spsc");
  EXPECT_EQ(claim_of(result), "nothing") << result.findings[0].evidence;
  EXPECT_TRUE(result.figures.contains("strengthened"));
  ASSERT_FALSE(result.limits.empty());
  EXPECT_NE(result.limits.back().find("no verdict"), std::string::npos) << result.limits.back();
}

TEST(SecondLook, ARaceThatNoFenceCoversIsAFinding) {
  if (sanitizer != Sanitizer::thread) GTEST_SKIP() << "the other builds do not look at races";
  const Result result = run_on(queue_entry<Fenced<true>::Queue>("fenced"), "spsc", 2);
  EXPECT_EQ(claim_of(result), "free of data races (ThreadSanitizer)");
  EXPECT_TRUE(result.figures.contains("strengthened"));
}

TEST(ProgressSuite, SeesThatALockBlocks) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result honest = run(broken_entry<Defect::none>(), 3, run_progress);
  EXPECT_TRUE(honest.findings.empty());
  const Result boast = run(broken_entry<Defect::none, Progress::lock_free>(), 3, run_progress);
  EXPECT_NE(claim_of(boast).find("goes on when another thread is stopped"), std::string::npos)
      << claim_of(boast);
}

TEST(ProgressSuite, SeesThatAStoppedThreadHidesElements) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result boast = run(queue_entry<Vyukov<VyukovBug::boasts>::Queue>("boast"), 5, run_progress);
  EXPECT_NE(claim_of(boast).find("goes on when another thread is stopped"), std::string::npos)
      << claim_of(boast);
  EXPECT_NE(boast.findings[0].evidence.find("answered"), std::string::npos)
      << boast.findings[0].evidence;
}

TEST(ProgressSuite, LeavesALockFreeQueueAlone) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result result =
      run(queue_entry<Recycled<RecycledBug::none>::Queue>("list"), 2, run_progress);
  EXPECT_EQ(claim_of(result), "nothing") << result.findings[0].evidence;
  EXPECT_GT(result.figures.value("suspensions", 0), 0);
}

TEST(FaultSuite, FindsHalfDonePushesAndLeaks) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  EXPECT_EQ(claim_of(run(broken_entry<Defect::throws>(), 1, run_faults)),
            "refuses an element entirely when an allocation fails");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::leaks>(), 1, run_faults)),
            "leaks nothing when an allocation fails");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::none>(), 1, run_faults)), "nothing");
}

TEST(MemorySuite, FindsMemoryThatGrowsWithEveryPush) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  EXPECT_EQ(claim_of(run(broken_entry<Defect::grows>(), 1, run_memory)), "reclaims memory");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::none>(), 1, run_memory)), "nothing");
}

}  // namespace
}  // namespace irt::stress
