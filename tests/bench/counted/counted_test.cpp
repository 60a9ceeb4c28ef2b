#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "bench/counted/atomic_events.hpp"
#include "bench/counted/counted_queue.hpp"
#include "bench/counted/pairs.hpp"
#include "queues/registry.hpp"
#include "tests/bench/counted/probe.hpp"

namespace irt {
namespace {

TEST(Counting, counts_compare_and_swaps_and_those_that_fail) {
  std::atomic<std::uint64_t> word{0};
  atomic_events() = {};
  compare_and_swap(word, 7, 3);
  EXPECT_EQ(atomic_events().compare_exchanges, 10U);
  EXPECT_EQ(atomic_events().failed_compare_exchanges, 3U);
  EXPECT_EQ(atomic_events().loads, 7U);
  EXPECT_EQ(word, 7U);
}

TEST(Counting, counts_those_of_16_bytes) {
  atomic_events() = {};
  EXPECT_TRUE(compare_and_swap_pairs(4, 2));
  EXPECT_EQ(atomic_events().compare_exchanges, 6U);
  EXPECT_EQ(atomic_events().failed_compare_exchanges, 2U);
}

TEST(Counting, does_what_was_asked_for) {
  std::atomic<std::uint64_t> word{12};
  atomic_events() = {};
  EXPECT_EQ(modify(word), 12U + 13 + 11 + 15 + 6);
  EXPECT_EQ(word, 20U);
  EXPECT_EQ(atomic_events().other_modifications, 5U);
  EXPECT_EQ(atomic_events().loads, 1U);
  EXPECT_EQ(atomic_events().stores, 2U);
}

// Whatever the threads do to each other, each knows how many tries it made.
TEST(Counting, is_each_threads_own) {
  constexpr unsigned times = 200'000;
  std::atomic<std::uint64_t> word{0};
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 4; ++i)
    threads.emplace_back([&word] {
      atomic_events() = {};
      const std::uint64_t tries = raise(word, times);
      EXPECT_EQ(atomic_events().compare_exchanges, tries);
      EXPECT_EQ(atomic_events().failed_compare_exchanges, tries - times);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(word, 4U * times);
}

AtomicEvents of_pairs(std::string_view name, unsigned pairs) {
  const auto queue = counted_queue(QueueRegistry(), name)->make_word_queue(1, 16);
  std::uint64_t word = 0;
  atomic_events() = {};
  for (unsigned i = 0; i < pairs; ++i) {
    EXPECT_TRUE(queue->push(0, i));
    EXPECT_TRUE(queue->pop(0, word));
  }
  return atomic_events();
}

TEST(CountedQueue, shows_the_algorithms_operations) {
  const AtomicEvents michael_scott = of_pairs("lfree", 1000);
  EXPECT_EQ(michael_scott.compare_exchanges, 3000U) << "link a node, move the tail, move the head";
  EXPECT_EQ(michael_scott.failed_compare_exchanges, 0U);
  const AtomicEvents counters = of_pairs("faa", 1000);
  EXPECT_EQ(counters.other_modifications, 2000U);
  EXPECT_EQ(counters.compare_exchanges, 0U);
}

TEST(CountedQueue, is_absent_where_it_cannot_be_seen) {
  EXPECT_EQ(counted_queue(QueueRegistry(), "no such queue"), nullptr);
  EXPECT_EQ(counted_queue(QueueRegistry(), "libcds-ms"), nullptr);
}

TEST(CountedPairs, come_from_both_builds_in_turn) {
  const QueueRegistry registry;
  const CountedPairs pairs = count_pairs(registry.at("lfree"), *counted_queue(registry, "lfree"),
                                         {.threads = 2, .seconds = 0.02, .rounds = 3});
  EXPECT_EQ(pairs.plain_per_second.size(), 3U);
  EXPECT_EQ(pairs.counted_per_second.size(), 3U);
  EXPECT_GT(pairs.operations, 0U);
  EXPECT_GE(pairs.events.compare_exchanges - pairs.events.failed_compare_exchanges,
            pairs.operations);
}

}  // namespace
}  // namespace irt
