// Hand-made histories, good and bad, for every oracle.
#include <algorithm>
#include <gtest/gtest.h>

#include "hand_made.hpp"
#include "stress/history/happens_before.hpp"
#include "stress/history/judge.hpp"

namespace irt::stress {
namespace {

constexpr Element a0 = element(0, 0);
constexpr Element a1 = element(0, 1);
constexpr Element a2 = element(0, 2);
constexpr Element b0 = element(1, 0);
constexpr Element c0 = element(2, 0);

Claims claims(Ordering ordering) {
  return {.ordering = ordering};
}

bool accuses(const Verdict& verdict, Pattern pattern) {
  return std::ranges::any_of(verdict.violations,
                             [=](const Violation& v) { return v.pattern == pattern; });
}

TEST(ExactlyOnce, AcceptsARunInOrder) {
  const History h = history({{push(a0, 0, 1), push(a1, 2, 3)}, {pop(a0, 4, 5), empty(6, 7)}},
                            {pop(a1, 8, 9), empty(10, 11)});
  // The empty at 6..7 is wrong (a1 is inside), the elements are all there.
  const Verdict verdict = judge(h, claims(Ordering::unordered), 0);
  EXPECT_TRUE(verdict.violations.empty());
  EXPECT_EQ(verdict.pushes, 2U);
  EXPECT_EQ(verdict.pops, 2U);
}

TEST(ExactlyOnce, FindsALostElement) {
  const History h = history({{push(a0, 0, 1), push(a1, 2, 3)}, {pop(a0, 4, 5)}}, {empty(6, 7)});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::unordered), 0), Pattern::lost));
}

TEST(ExactlyOnce, FindsADoubledElement) {
  const History h = history({{push(a0, 0, 1)}, {pop(a0, 2, 3)}, {pop(a0, 4, 5)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::unordered), 0), Pattern::repeat));
}

TEST(ExactlyOnce, FindsAnInventedElement) {
  const History h = history({{push(a0, 0, 1)}, {pop(0xdeadbeefdeadbeef, 2, 3)}}, {pop(a0, 4, 5)});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::unordered), 0), Pattern::fresh));
}

TEST(ExactlyOnce, AllowsRefusedElementsAndGaps) {
  const History h = history({{push(a0, 0, 1), full(a1, 2, 3), push(element(0, 2), 4, 5)}},
                            {pop(a0, 6, 7), pop(element(0, 2), 8, 9)});
  Claims ring = claims(Ordering::fifo_real_time);
  ring.bounded = true;
  EXPECT_TRUE(judge(h, ring, 1).violations.empty());
}

TEST(RealTime, FindsSwappedElements) {
  const History h = history({{push(a0, 0, 1)}, {push(b0, 2, 3)}, {pop(b0, 4, 5)}, {pop(a0, 6, 7)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_real_time), 0), Pattern::order));
  // Nothing but the clock orders the two pushes.
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_happens_before), 0).violations.empty());
}

TEST(RealTime, AllowsSwappedElementsWhosePushesOverlap) {
  const History h = history({{push(a0, 0, 3)}, {push(b0, 2, 3)}, {pop(b0, 4, 5)}, {pop(a0, 6, 7)}});
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_real_time), 0).violations.empty());
}

TEST(RealTime, TiesCountAsConcurrent) {
  const History h = history({{push(a0, 0, 2)}, {push(b0, 2, 3)}, {pop(b0, 4, 5)}, {pop(a0, 6, 7)}});
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_real_time), 0).violations.empty());
}

TEST(RealTime, TheErrorOfTheClockWidensEveryInterval) {
  History h =
      history({{push(a0, 0, 10)}, {push(b0, 30, 40)}, {pop(b0, 60, 70)}, {pop(a0, 90, 99)}});
  h.error = 9;
  EXPECT_FALSE(judge(h, claims(Ordering::fifo_real_time), 0).violations.empty());
  h.error = 10;
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_real_time), 0).violations.empty());
}

TEST(RealTime, FindsAFalseEmpty) {
  const History h = history({{push(a0, 0, 1)}, {empty(2, 3)}, {pop(a0, 4, 5)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_real_time), 0), Pattern::witness));
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_happens_before), 0).violations.empty());
}

TEST(RealTime, FindsAFalseEmptyThatOnlyTwoElementsTogetherRefute) {
  const History h = history(
      {{push(a0, 0, 1)}, {push(b0, 4, 5)}, {empty(2, 9)}, {pop(a0, 7, 8), pop(b0, 10, 11)}});
  const Verdict verdict = judge(h, claims(Ordering::fifo_real_time), 0);
  ASSERT_TRUE(accuses(verdict, Pattern::witness));
  EXPECT_EQ(verdict.violations[0].culprits.size(), 5U) << "two pushes, two pops and the empty";
}

TEST(RealTime, AllowsAnEmptyInAGap) {
  const History h =
      history({{push(a0, 0, 1)}, {push(b0, 6, 7)}, {empty(2, 8)}, {pop(a0, 4, 5), pop(b0, 9, 10)}});
  EXPECT_TRUE(judge(h, claims(Ordering::fifo_real_time), 0).violations.empty());
}

TEST(RealTime, FindsAPopBeforeItsPush) {
  const History h = history({{push(a0, 4, 5)}, {pop(a0, 0, 1)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_real_time), 0), Pattern::fresh));
}

TEST(HappensBefore, FindsSwappedElementsOfOneProducer) {
  const History h = history({{push(a0, 0, 1), push(a1, 2, 3)}, {pop(a1, 4, 5), pop(a0, 6, 7)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_happens_before), 0), Pattern::order));
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::per_producer_fifo), 0), Pattern::order));
  EXPECT_TRUE(judge(h, claims(Ordering::unordered), 0).violations.empty());
}

TEST(HappensBefore, OrdersElementsThroughWhatAWorkerTook) {
  // Worker 1 pushes b0 after it took a0 of worker 0, who had pushed a0 before a1: b0 is younger
  // than a0 only. Swapping b0 and a1 is fine, swapping them with a0 is not.
  const History fine = history({{push(a0, 0, 1), push(a1, 2, 3)}, {pop(a0, 4, 5), push(b0, 6, 7)}},
                               {pop(b0, 8, 9), pop(a1, 10, 11)});
  EXPECT_TRUE(judge(fine, claims(Ordering::fifo_happens_before), 0).violations.empty());
  // Here worker 0 pushed a0 and a1 before a2, and b0 follows a2: b0 must leave after a1.
  const History wrong =
      history({{push(a0, 0, 1), push(a1, 2, 3), push(a2, 4, 5)}, {pop(a2, 6, 7), push(b0, 8, 9)}},
              {pop(a0, 10, 11), pop(b0, 12, 13), pop(a1, 14, 15)});
  EXPECT_TRUE(accuses(judge(wrong, claims(Ordering::fifo_happens_before), 0), Pattern::order));
}

TEST(HappensBefore, FindsAnEmptyAfterTheWorkersOwnPush) {
  const History h = history({{push(a0, 0, 1), empty(2, 3), pop(a0, 4, 5)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_happens_before), 0), Pattern::witness));
  const Verdict relaxed = judge(h, claims(Ordering::unordered), 0);
  EXPECT_TRUE(accuses(relaxed, Pattern::witness)) << "nobody else was there";
  EXPECT_EQ(relaxed.refuted_empties, 1U);
}

TEST(Empty, IsExcusedByCallsInFlightWhereThatIsClaimed) {
  // Worker 1 pushes and pops at any time: nothing orders it with what worker 0 does.
  const History h =
      history({{push(a0, 0, 1), empty(2, 3), pop(a0, 4, 5)}, {push(b0, 2, 3), pop(b0, 6, 7)}});
  Claims bag = claims(Ordering::unordered);
  const Verdict verdict = judge(h, bag, 0);
  EXPECT_TRUE(verdict.violations.empty());
  EXPECT_EQ(verdict.refuted_empties, 1U);
  bag.empty = Answer::exact;
  EXPECT_TRUE(accuses(judge(h, bag, 0), Pattern::witness));
  Claims fifo = claims(Ordering::fifo_happens_before);
  EXPECT_TRUE(accuses(judge(h, fifo, 0), Pattern::witness));
  fifo.empty = Answer::calls_in_flight;
  EXPECT_TRUE(judge(h, fifo, 0).violations.empty());
}

TEST(Empty, IsNoExcuseForAnotherWhileTheSameElementWasInside) {
  // Both find nothing behind the barrier before which a0 was pushed.
  const History h = history({{push(a0, 0, 1), meet(2), empty(3, 4), meet(5)},
                             {meet(2), empty(3, 4), meet(5), pop(a0, 6, 7)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::unordered), 0), Pattern::witness));
  // The second one may have looked before the push, and hold what the first then misses.
  const History doubtful =
      history({{push(a0, 0, 1), empty(3, 4), meet(5)}, {empty(3, 4), meet(5), pop(a0, 6, 7)}});
  EXPECT_TRUE(judge(doubtful, claims(Ordering::unordered), 0).violations.empty());
}

TEST(Empty, OfOneWorkerIsRefutedByThatWorkerAlone) {
  Claims local = claims(Ordering::unordered);
  local.empty = Answer::this_worker;
  const History others =
      history({{push(a0, 0, 1), meet(2), meet(5), pop(a0, 6, 7)}, {meet(2), empty(3, 4), meet(5)}});
  EXPECT_TRUE(judge(others, local, 0).violations.empty());
  EXPECT_TRUE(accuses(judge(others, claims(Ordering::unordered), 0), Pattern::witness));
  const History same = history({{push(a0, 0, 1), empty(2, 3), empty(4, 5), pop(a0, 6, 7)}});
  EXPECT_TRUE(accuses(judge(same, local, 0), Pattern::witness));
  const History moved =
      history({{push(a0, 0, 1), empty(2, 3), pop(a0, 6, 7)}, {push(b0, 2, 3), pop(b0, 4, 5)}});
  EXPECT_TRUE(judge(moved, local, 0).violations.empty()) << "somebody was at work in between";
  const History left = history(
      {{push(a0, 0, 1), meet(2), empty(3, 4), pop(a0, 6, 7)}, {meet(2), {4, 5, 0, Kind::leave}}});
  EXPECT_TRUE(judge(left, local, 0).violations.empty()) << "who leaves may give something back";
}

TEST(HappensBefore, FindsAnEmptyBehindABarrier) {
  const History h = history({{push(a0, 0, 1), meet(2)}, {meet(2), empty(3, 4), pop(a0, 5, 6)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_happens_before), 0), Pattern::witness));
  const History before =
      history({{push(a0, 0, 1), meet(2)}, {empty(1, 2), meet(2), pop(a0, 5, 6)}});
  EXPECT_TRUE(judge(before, claims(Ordering::fifo_happens_before), 0).violations.empty());
}

TEST(HappensBefore, TheDrainComesAfterEverything) {
  const History h = history({{push(a0, 0, 1)}}, {empty(2, 3), pop(a0, 4, 5)});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::fifo_happens_before), 0), Pattern::witness));
}

TEST(HappensBefore, FindsACycle) {
  const History h = history({{pop(b0, 0, 1), push(a0, 2, 3)}, {pop(a0, 0, 1), push(b0, 2, 3)}});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::unordered), 0), Pattern::fresh));
}

TEST(Full, IsJudgedByWhatCanHaveBeenInsideWhateverTheOrder) {
  for (const Ordering ordering :
       {Ordering::unordered, Ordering::per_producer_fifo, Ordering::k_relaxed_fifo,
        Ordering::fifo_happens_before, Ordering::fifo_real_time}) {
    Claims ring = claims(ordering);
    ring.bounded = true;
    const std::vector<Operation> drain{pop(a0, 20, 21)};
    const History h = history({{push(a0, 0, 1), full(a1, 2, 3)}}, drain);
    EXPECT_TRUE(judge(h, ring, 1).violations.empty());
    EXPECT_TRUE(accuses(judge(h, ring, 2), Pattern::full));
  }
}

TEST(Full, IsExactWithoutFifoOnlyWhileNoPopRuns) {
  // The second push may have come upon the place that the pop has not given back yet.
  const History meets_a_pop =
      history({{push(a0, 0, 1), full(a1, 4, 5)}, {pop(a0, 2, 6), push(b0, 7, 8), pop(b0, 9, 10)}});
  Claims ring = claims(Ordering::fifo_happens_before);
  ring.bounded = true;
  EXPECT_TRUE(accuses(judge(meets_a_pop, ring, 3), Pattern::full));
  ring.ordering = Ordering::per_producer_fifo;
  EXPECT_TRUE(judge(meets_a_pop, ring, 3).violations.empty());
}

TEST(Full, OfFifoQueuesCountsCallsInFlightWhereThatIsClaimed) {
  const History h =
      history({{push(a0, 0, 1), full(a1, 4, 5)}, {pop(a0, 2, 6), push(b0, 7, 8), pop(b0, 9, 10)}});
  for (const Ordering order : {Ordering::fifo_happens_before, Ordering::fifo_real_time}) {
    Claims ring = claims(order);
    ring.bounded = true;
    EXPECT_TRUE(accuses(judge(h, ring, 3), Pattern::full));
    ring.full = Answer::calls_in_flight;
    EXPECT_TRUE(judge(h, ring, 3).violations.empty());
  }
}

TEST(Full, CountsAPlaceForEachWorkerThatIsBeingRefused) {
  // One place: who is refused may have held it for a moment.
  const History two =
      history({{push(a0, 0, 1)}, {full(b0, 2, 3)}, {full(element(2, 0), 2, 3)}}, {pop(a0, 20, 21)});
  Claims bag = claims(Ordering::unordered);
  bag.bounded = true;
  EXPECT_TRUE(judge(two, bag, 2).violations.empty());
  EXPECT_TRUE(accuses(judge(two, bag, 3), Pattern::full));
}

TEST(Full, IsNoAnswerOfAnUnboundedQueue) {
  const History h = history({{push(a0, 0, 1), full(a1, 2, 3)}}, {pop(a0, 20, 21)});
  EXPECT_TRUE(accuses(judge(h, claims(Ordering::per_producer_fifo), 0), Pattern::full));
}

TEST(Full, APopThatHasNotReturnedStillHoldsItsPlace) {
  Claims ring = claims(Ordering::fifo_real_time);
  ring.bounded = true;
  const History overlapping = history({{push(a0, 0, 1), full(a1, 4, 5)}, {pop(a0, 2, 6)}});
  EXPECT_TRUE(judge(overlapping, ring, 1).violations.empty());
  const History finished = history({{push(a0, 0, 1), full(a1, 4, 5)}, {pop(a0, 2, 3)}});
  EXPECT_TRUE(accuses(judge(finished, ring, 1), Pattern::full));
  ring.ordering = Ordering::fifo_happens_before;
  EXPECT_TRUE(judge(finished, ring, 1).violations.empty());
}

TEST(Relaxation, CountsWhatWasOvertaken) {
  Claims relaxed = claims(Ordering::k_relaxed_fifo);
  relaxed.relaxation = 2;
  std::vector<Operation> pushes;
  for (std::uint64_t i = 0; i < 4; ++i) pushes.push_back(push(element(0, i), 2 * i, 2 * i + 1));
  // The fourth leaves first: it passes three older ones.
  const History h = history(
      {pushes,
       {pop(element(0, 3), 10, 11), pop(a0, 12, 13), pop(a1, 14, 15), pop(element(0, 2), 16, 17)}});
  const Verdict verdict = judge(h, relaxed, 0);
  ASSERT_TRUE(verdict.relaxation.has_value());
  EXPECT_EQ(verdict.relaxation->rank_error.max, 3U);
  EXPECT_EQ(verdict.relaxation->overtaken.max, 1U);
  EXPECT_DOUBLE_EQ(verdict.relaxation->overtaken.mean, 0.75);
  EXPECT_TRUE(accuses(verdict, Pattern::rank));
  relaxed.relaxation = 3;
  EXPECT_TRUE(judge(h, relaxed, 0).violations.empty());
}

TEST(Overtaking, GoesByWhoseCallBeganFirst) {
  // b0's push begins last and enters first: a0 and c0 are overtaken, in an order that is FIFO.
  const History pushes = history({{push(a0, 0, 9)}, {push(b0, 2, 4)}, {push(c0, 1, 8)}},
                                 {pop(b0, 10, 11), pop(a0, 12, 13), pop(c0, 14, 15)});
  const Relaxation of_pushes = measure_relaxation(Matching(pushes));
  EXPECT_EQ(of_pushes.rank_error.max, 0U);
  EXPECT_DOUBLE_EQ(of_pushes.pushes_overtaken, 2. / 3);
  EXPECT_DOUBLE_EQ(of_pushes.pops_overtaken, 0);

  // The pop that begins last gets the oldest element.
  const History pops = history({{push(a0, 0, 1), push(a1, 2, 3), push(a2, 4, 5)},
                                {pop(a1, 10, 19)},
                                {pop(a0, 12, 14)},
                                {pop(a2, 11, 20)}});
  const Relaxation of_pops = measure_relaxation(Matching(pops));
  EXPECT_DOUBLE_EQ(of_pops.pushes_overtaken, 0);
  EXPECT_DOUBLE_EQ(of_pops.pops_overtaken, 2. / 3);

  History unsure = pops;
  unsure.error = 2;
  EXPECT_DOUBLE_EQ(measure_relaxation(Matching(unsure)).pops_overtaken, 0);
}

TEST(Overtaking, CanBeMeasuredOfWordsThatComeAgain) {
  constexpr Element word = 77;
  // The pop that began first waited for the second push.
  const History h = distinct(
      {{push(word, 1, 2), pop(word, 0, 7)}, {pop(word, 2, 3), push(word, 4, 5), push(5, 8, 9)}}, 0);
  const Matching matching(h);
  EXPECT_TRUE(matching.violations().empty());
  EXPECT_EQ(h.logs[0][1].value, h.logs[1][1].value);
  EXPECT_NE(h.logs[0][0].value, h.logs[1][1].value);
  EXPECT_EQ(matching.lives()[1].size(), 2U);
}

TEST(OwnWorker, EachWorkersQueueIsJudgedAlone) {
  Claims local = claims(Ordering::fifo_real_time);
  local.producers = Callers::own_worker;
  local.consumers = Callers::own_worker;
  const History fine =
      history({{push(a0, 0, 1), pop(a0, 8, 9)}, {empty(2, 3), push(b0, 4, 5)}}, {pop(b0, 10, 11)});
  EXPECT_TRUE(judge(fine, local, 0).violations.empty());
  const History stolen = history({{push(a0, 0, 1)}, {pop(a0, 2, 3)}});
  EXPECT_TRUE(accuses(judge(stolen, local, 0), Pattern::fresh));
}

TEST(OwnWorker, TheRelaxationIsThatOfAllTogether) {
  Claims local = claims(Ordering::per_producer_fifo);
  local.producers = Callers::own_worker;
  local.consumers = Callers::own_worker;
  const History h = history({{push(a0, 0, 1)}, {push(b0, 2, 3), pop(b0, 4, 5)}}, {pop(a0, 6, 7)});
  const Verdict verdict = judge(h, local, 0);
  EXPECT_TRUE(verdict.violations.empty());
  ASSERT_TRUE(verdict.relaxation.has_value());
  EXPECT_EQ(verdict.relaxation->rank_error.max, 1U);
}

TEST(Explain, DrawsTheOperationsToScale) {
  const History h = history({{push(a0, 0, 100)}, {empty(200, 300)}, {pop(a0, 400, 500)}});
  const Verdict verdict = judge(h, claims(Ordering::fifo_real_time), 0);
  ASSERT_EQ(verdict.violations.size(), 1U);
  EXPECT_EQ(
      explain(verdict.violations[0], 1),
      "pop answered empty although the queue held an element all the while\n"
      "  worker 0   push 0:0         |------|                                 0 .. 100 ns\n"
      "  worker 1   pop  empty                      |-------|                 200 .. 300 ns\n"
      "  worker 2   pop  0:0                                        |-------| 400 .. 500 ns\n");
}

}  // namespace
}  // namespace irt::stress
