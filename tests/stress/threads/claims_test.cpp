// What claims mean to suites on real threads: no more is asked for, and no less.
#include <gtest/gtest.h>

#include "../cases/answers.hpp"
#include "../cases/dropped_list.hpp"
#include "../cases/dropped_ring.hpp"
#include "../cases/one_short.hpp"
#include "../cases/roles.hpp"
#include "../cases/unpublished.hpp"
#include "running.hpp"
#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

TEST(ClaimsOnThreads, FindsAFalseEmptyAndAFalseFullWithoutAnyOrder) {
  EXPECT_EQ(claim_of(run_on(queue_entry<HalfBlindBug>("half-blind"), "roles", 3)),
            "empty only when empty");
  EXPECT_EQ(claim_of(run_on(queue_entry<OneShortUnorderedBug>("short"), "built-and-dropped", 3)),
            "keeps its contract");
}

// What they claim is all that is asked of them; and nobody acts in another's part.
TEST(ClaimsOnThreads, AsksForNoMoreThanIsClaimed) {
  const QueueEntry modest[] = {queue_entry<HalfBlindFixed>("bag"),
                               queue_entry<CreditedInFlight>("credited"),
                               queue_entry<HoardingHonest>("hoarding"),
                               queue_entry<Picky>("picky"),
                               queue_entry<KnowsItsWorkers>("knows-its-workers"),
                               queue_entry<KnowsItsConsumer>("knows-its-consumer"),
                               queue_entry<KnowsEachWorker>("knows-each-worker")};
  for (const QueueEntry& queue : modest) {
    for (const Scenario& scenario : scenarios()) {
      const Result result = run_on(queue, scenario.name, 0.1);
      EXPECT_TRUE(result.findings.empty())
          << queue.name << " in " << scenario.name << ": " << claim_of(result) << "\n"
          << result.findings[0].evidence;
    }
    if (sanitizer != Sanitizer::none) continue;
    EXPECT_EQ(claim_of(run(queue, 0.5, run_faults)), "nothing") << queue.name;
    EXPECT_EQ(claim_of(run(queue, 0.5, run_progress)), "nothing") << queue.name;
  }
}

TEST(ClaimsOnThreads, DestroysQueuesWithElementsInside) {
  for (const QueueEntry& queue : {queue_entry<DroppedListFixed>("dropped-list"),
                                  queue_entry<DroppedRingFixed>("dropped-ring")}) {
    const Result result = run_on(queue, "left-inside", 0.5);
    EXPECT_TRUE(result.findings.empty()) << queue.name << ": " << result.findings[0].evidence;
  }
  EXPECT_NE(claim_of(run_on(queue_entry<DroppedListTwiceBug>("frees-twice"), "left-inside", 3)),
            "nothing");
  if (sanitizer != Sanitizer::address) GTEST_SKIP() << "only AddressSanitizer sees the others";
  for (const QueueEntry& queue :
       {queue_entry<DroppedListUsesBug>("uses"), queue_entry<DroppedListLeaksBug>("leaks")})
    EXPECT_NE(claim_of(run_on(queue, "left-inside", 3)), "nothing") << queue.name;
}

TEST(ClaimsOnThreads, FindsElementsThatAreNotPublished) {
  EXPECT_EQ(claim_of(run_on(queue_entry<UnpublishedFixed>("published"), "mpmc")), "nothing");
  if (sanitizer != Sanitizer::thread) GTEST_SKIP() << "the other builds do not look at races";
  EXPECT_EQ(claim_of(run_on(queue_entry<UnpublishedBug>("unpublished"), "mpmc", 3)),
            "free of data races (ThreadSanitizer)");
}

}  // namespace
}  // namespace irt::stress
