// Every suite must find the defect it is for, and leave a healthy queue alone.
#include "stress/threads/suites.hpp"

#include <gtest/gtest.h>

#include "../cases/answers.hpp"
#include "../cases/narrow_index.hpp"
#include "broken_queues.hpp"
#include "fenced_ring.hpp"
#include "rare_queues.hpp"
#include "running.hpp"
#include "stress/mutants/parking.hpp"
#include "stress/threads/sanitizer.hpp"
#include "tests/stress/cases/handles.hpp"
#include "tests/stress/cases/notified_twice.hpp"
#include "tests/stress/cases/waiting_pops.hpp"

namespace irt::stress {
namespace {

TEST(ScenarioSuite, LeavesAHealthyQueueAlone) {
  for (const Scenario& scenario : scenarios()) {
    if (!allows(Methods{}, Claims{}, scenario)) continue;
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

// Counters that wrap, and capacities that are no powers of two.
TEST(ScenarioSuite, FindsNarrowCounters) {
  EXPECT_NE(claim_of(run_on(queue_entry<NarrowIndexBug>("narrow8"), "spsc", 2)), "nothing");
  if (sanitizer != Sanitizer::none) return;  // too slow to grow old
  EXPECT_NE(claim_of(run_on(queue_entry<NarrowIndex16Bug>("narrow16"), "spsc", 8)), "nothing");
  EXPECT_EQ(claim_of(run_on(queue_entry<NarrowIndexFixed>("wide"), "spsc", 1)), "nothing");
}

// What a handle does when its thread leaves belongs to the run.
TEST(ScenarioSuite, FindsWhatLeavingBreaks) {
  EXPECT_EQ(claim_of(run_on(queue_entry<TwoAtATimeForgets>("forgets"), "mpmc")),
            "no element is lost");
  EXPECT_EQ(claim_of(run_on(queue_entry<TwoAtATime>("gives-back"), "mpmc")), "nothing");
  EXPECT_EQ(claim_of(run_on(queue_entry<TwoAtATime>("gives-back"), "come-and-go")), "nothing");
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

TEST(FaultSuite, FindsHalfDonePushesAndLeaks) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  EXPECT_EQ(claim_of(run(broken_entry<Defect::throws>(), 1, run_faults)),
            "refuses an element entirely when an allocation fails");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::leaks>(), 1, run_faults)),
            "leaks nothing when an allocation fails");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::none>(), 1, run_faults)), "nothing");
}

TEST(FaultSuite, AHangIsAFindingWithAStackAndTheAllocation) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  const Result result = run(queue_entry<Growing<true>::Queue>("growing"), 1, run_faults);
  EXPECT_EQ(claim_of(result).substr(0, 13), "does not hang") << claim_of(result);
  const std::string& evidence = result.findings[0].evidence;
  EXPECT_NE(evidence.find("in push"), std::string::npos) << evidence;
  EXPECT_NE(evidence.find("Growing"), std::string::npos) << evidence;
  EXPECT_NE(evidence.find("with allocation number 2 failing"), std::string::npos) << evidence;
  EXPECT_EQ(claim_of(run(queue_entry<Growing<false>::Queue>("growing"), 1, run_faults)), "nothing");
}

TEST(SustainedSuite, CountsWhatIsLostAndDoubled) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "only the scenarios run under a sanitizer";
  const Result lost = run(queue_entry<Rare<true>::Queue>("loses"), 1, run_sustained);
  EXPECT_EQ(claim_of(lost), "no element is lost");
  const Result doubled = run(queue_entry<Rare<false>::Queue>("doubles"), 1, run_sustained);
  EXPECT_EQ(claim_of(doubled), "every element leaves once");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::reorders>(), 1, run_sustained)), "order of elements");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::hangs>(), 1, run_sustained)).substr(0, 13),
            "does not hang");
  const Result healthy = run(broken_entry<Defect::none>(), 1, run_sustained);
  EXPECT_EQ(claim_of(healthy), "nothing");
  EXPECT_GT(healthy.figures.value("quiescent_points", 0), 10);
}

// At rest there is no call in flight to excuse anything.
TEST(SustainedSuite, AsksForEveryPlaceAndEveryElementWhenAllStandStill) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "only the scenarios run under a sanitizer";
  const auto claim = [](const QueueEntry& entry) { return claim_of(run(entry, 2, run_sustained)); };
  EXPECT_EQ(claim(queue_entry<WithBound<Bounded::loses_places>::Queue>("places")),
            "full only when full");
  EXPECT_EQ(claim(queue_entry<WithBound<Bounded::loses_deep>::Queue>("deep")),
            "no element is lost");
  EXPECT_EQ(claim(queue_entry<HoardingBoast>("boast")), "empty only when empty");
  EXPECT_EQ(claim(queue_entry<HoardingHonest>("honest")), "nothing");
  EXPECT_EQ(claim(queue_entry<WithBound<Bounded::sound>::Queue>("sound")), "nothing");
}

TEST(OnEmpty, KnowsAPopThatWaits) {
  EXPECT_TRUE(pop_answers_on_empty(broken_entry<Defect::none>()));
  EXPECT_TRUE(pop_answers_on_empty(queue_entry<Parking<ParkingBug::none>::Queue>("parking")));
  EXPECT_FALSE(pop_answers_on_empty(queue_entry<PopsForEver>("waits")));
}

TEST(WaitingPops, LostWakeUpsAreFound) {
  for (const Scenario& scenario : scenarios()) {
    if (!scenario.needs.pop_wait || scenario.needs.deadline) continue;
    const auto test = [&](const QueueEntry& entry) {
      return claim_of(run_on(entry, scenario.name));
    };
    EXPECT_EQ(test(queue_entry<NotifiedTwiceFixed>("once")), "nothing");
    EXPECT_EQ(test(queue_entry<Parking<ParkingBug::none>::Queue>("parking")), "nothing");
    EXPECT_EQ(test(queue_entry<EventCounted<true>::Queue>("counted")), "nothing");
    if (scenario.name == "parked-closed-early") continue;  // which wakes everybody in the end
    // Whether the two pushes meet is up to the processors, which may be busy.
    std::string lost;
    for (int tries = 0; tries < 5 && lost != "does not hang"; ++tries)
      lost = test(queue_entry<NotifiedTwiceBug>("twice")).substr(0, 13);
    EXPECT_EQ(lost, "does not hang");
    EXPECT_NE(test(queue_entry<Parking<ParkingBug::if_not_while>::Queue>("parking")), "nothing");
  }
}

TEST(WaitingPops, WrongEndsOfWaitingAreFound) {
  const auto test = [](const QueueEntry& entry, std::string_view scenario) {
    std::string claim = "nothing";
    for (int tries = 0; tries < 40 && claim == "nothing"; ++tries)
      claim = claim_of(run_on(entry, scenario));
    return claim;
  };
  EXPECT_EQ(test(queue_entry<Waits<WaitingBug::impatient>::Queue>("early"), "parked-for-a-while"),
            "keeps its contract");
  EXPECT_EQ(test(queue_entry<Waits<WaitingBug::deaf>::Queue>("deaf"), "parked-for-a-while"),
            "closing is the end of pushes, of waiting and of elements");
  for (const auto& entry : {queue_entry<Waits<WaitingBug::accepts>::Queue>("accepts"),
                            queue_entry<Waits<WaitingBug::leaves_behind>::Queue>("leaves")})
    EXPECT_EQ(test(entry, "parked-closed-early"),
              "closing is the end of pushes, of waiting and of elements");
  for (const Scenario& scenario : scenarios()) {
    if (!scenario.needs.pop_wait) continue;
    EXPECT_EQ(claim_of(run_on(queue_entry<Waits<WaitingBug::none>::Queue>("sound"), scenario.name)),
              "nothing");
  }
}

TEST(Bulk, WrongCountsAndOrdersAreFound) {
  const auto test = [](const QueueEntry& entry) { return claim_of(run_on(entry, "bulk")); };
  EXPECT_EQ(test(queue_entry<Bulky<BulkBug::none>::Queue>("sound")), "nothing");
  EXPECT_EQ(test(queue_entry<Bulky<BulkBug::drops_last>::Queue>("drops")), "no element is lost");
  EXPECT_EQ(test(queue_entry<Bulky<BulkBug::backwards>::Queue>("turns")), "order of elements");
  EXPECT_EQ(test(queue_entry<Bulky<BulkBug::boasts>::Queue>("boasts")), "keeps its contract");
}

TEST(MemorySuite, FindsMemoryThatGrowsWithEveryPush) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  EXPECT_EQ(claim_of(run(broken_entry<Defect::grows>(), 60, run_memory)), "reclaims memory");
  EXPECT_EQ(claim_of(run(broken_entry<Defect::none>(), 1, run_memory)), "nothing");
}

}  // namespace
}  // namespace irt::stress
