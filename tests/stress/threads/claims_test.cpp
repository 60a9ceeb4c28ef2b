// What claims mean to suites on real threads: no more is asked for, and no less.
#include <gtest/gtest.h>

#include "../cases/answers.hpp"
#include "../cases/dropped_list.hpp"
#include "../cases/dropped_ring.hpp"
#include "../cases/one_short.hpp"
#include "../cases/roles.hpp"
#include "../cases/unpublished.hpp"
#include "claiming.hpp"
#include "running.hpp"
#include "stress/threads/complement.hpp"
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
      if (!allows(queue.methods, queue.claims, scenario)) continue;
      const Result result = run_on(queue, scenario.name, 0.05);
      EXPECT_TRUE(result.findings.empty())
          << queue.name << " in " << scenario.name << ": " << claim_of(result) << "\n"
          << result.findings[0].evidence;
    }
    if (sanitizer != Sanitizer::none) continue;
    EXPECT_EQ(claim_of(run(queue, 0.25, run_faults)), "nothing") << queue.name;
    EXPECT_EQ(claim_of(run(queue, 0.25, run_progress)), "nothing") << queue.name;
    EXPECT_EQ(claim_of(run(queue, 0.25, run_sustained)), "nothing") << queue.name;
  }
  if (sanitizer == Sanitizer::none) {
    EXPECT_EQ(claim_of(run(queue_entry<HoardingHonest>("hoarding"), 0.1, run_memory)), "nothing");
  }
}

template <Keeps keeps, bool told>
QueueEntry claiming() {
  return queue_entry<Claiming<keeps, told>::template Queue>(told ? "told" : "untold");
}

// Elements are small numbers; what a queue does to other words must come out all the same.
TEST(ClaimsOnThreads, FindsWordsAndWorkersThatAQueueKeepsUntold) {
  EXPECT_EQ(claim_of(run_on(claiming<Keeps::ones, false>(), "mpmc", 2)), "no element is lost");
  EXPECT_EQ(claim_of(run_on(claiming<Keeps::word, false>(), "mpmc", 2)), "no element is lost");
  EXPECT_EQ(claim_of(run_on(claiming<Keeps::high_bit, false>(), "mpmc", 2)),
            "pops only what was pushed");
  EXPECT_NE(claim_of(run_on(claiming<Keeps::low_bit, false>(), "mpmc", 2)), "nothing");
  EXPECT_EQ(claim_of(run_on(claiming<Keeps::seats, false>(), "crowd", 2)), "keeps its contract");
}

TEST(ClaimsOnThreads, LeavesOutWordsAndWorkersThatAQueueKeepsForItself) {
  for (const QueueEntry& queue :
       {claiming<Keeps::nothing, true>(), claiming<Keeps::ones, true>(),
        claiming<Keeps::word, true>(), claiming<Keeps::high_bit, true>(),
        claiming<Keeps::low_bit, true>(), claiming<Keeps::seats, true>()}) {
    for (const std::string_view scenario : {"mpmc", "crowd", "built-and-dropped"}) {
      const Result result = run_on(queue, scenario, 0.15);
      EXPECT_EQ(claim_of(result), "nothing") << scenario << "\n" << result.findings[0].evidence;
    }
    if (sanitizer != Sanitizer::none) continue;
    for (const auto suite : {run_sustained, run_faults, run_progress})
      EXPECT_EQ(claim_of(run(queue, 0.15, suite)), "nothing");
  }
}

TEST(ClaimsOnThreads, ComplementsAreTheirOwnInverseAndKeepWhatIsClaimed) {
  Claims claims;
  claims.unused_bits = 0xff00'0000'0000'0001;
  claims.reserved = {0, 16};
  const Complement complement(claims);
  const Claims seen = *complement.seen(claims);
  for (const Element e : {element(0, 0), element(0, 2), element(3, 18), complement(16)}) {
    EXPECT_EQ(complement(complement(e)), e);
    EXPECT_EQ(seen.allows(e), claims.allows(complement(e))) << e;
  }
  claims = {.all_ones_reserved = true};
  EXPECT_FALSE(Complement(claims).seen(claims)->allows(0));
  claims.reserved = {1, 2, 3, 4};
  EXPECT_FALSE(Complement(claims).seen(claims));  // five words have no place
}

TEST(ClaimsOnThreads, KnowsQueuesThatTakeNoElements) {
  Claims claims;
  EXPECT_TRUE(has_elements(claims));
  claims.unused_bits = 0xffff'0000'0000'000f;
  EXPECT_TRUE(has_elements(claims));
  claims.unused_bits = 0xffff'ffff'0000'0000;  // would be searched for ever
  EXPECT_FALSE(has_elements(claims));
  claims.unused_bits = 0xffff;
  EXPECT_FALSE(has_elements(claims));
}

/// Answers empty to a worker who then finds what had been inside.
template <class T>
class HalfBlindToItself : public HalfBlindCase<T, false> {
 public:
  static constexpr Claims claims{.bounded = true, .empty = Answer::this_worker};
  using HalfBlindCase<T, false>::HalfBlindCase;
};

TEST(ClaimsOnThreads, FindsAnswersThatNothingExcuses) {
  EXPECT_NE(claim_of(run_on(queue_entry<HalfBlindToItself>("itself"), "built-and-dropped", 10)),
            "nothing");
  EXPECT_EQ(claim_of(run_on(queue_entry<HoardingBoast>("boast"), "mpmc", 10)),
            "empty only when empty");
  if (sanitizer != Sanitizer::none) return;
  EXPECT_EQ(claim_of(run(queue_entry<OneShortUnorderedBug>("short"), 5, run_sustained)),
            "full only when full");
}

TEST(ClaimsOnThreads, DestroysQueuesWithElementsInside) {
  for (const QueueEntry& queue : {queue_entry<DroppedListFixed>("dropped-list"),
                                  queue_entry<DroppedRingFixed>("dropped-ring")}) {
    const Result result = run_on(queue, "left-inside", 0.5);
    EXPECT_TRUE(result.findings.empty()) << queue.name << ": " << result.findings[0].evidence;
  }
  if (sanitizer == Sanitizer::thread)
    GTEST_SKIP() << "ThreadSanitizer's allocator takes a block back twice without a word";
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
