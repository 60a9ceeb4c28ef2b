/// The baselines that only count: what they answer, alone and among threads.
#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "queues/registry.hpp"

namespace irt {
namespace {

const QueueEntry& counter(std::string_view name) {
  static const QueueRegistry registry;
  return registry.at_or_counter(name);
}

class Counters : public testing::TestWithParam<const char*> {};

TEST_P(Counters, let_out_as_many_as_came_in) {
  const auto queue = counter(GetParam()).make_word_queue(1, 1);
  std::uint64_t word = 7;
  EXPECT_FALSE(queue->pop(0, word));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue->push(0, 1));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue->pop(0, word));
  EXPECT_FALSE(queue->pop(0, word));
  EXPECT_EQ(word, 7U);
}

// Pops meet each other at the end of what there is, over and over.
TEST_P(Counters, let_out_as_many_as_came_in_among_threads) {
  constexpr unsigned workers = 4;
  constexpr std::uint64_t each = 100'000;
  const auto queue = counter(GetParam()).make_word_queue(workers, 1);
  std::atomic<std::uint64_t> popped{0};
  std::vector<std::thread> threads;
  for (unsigned worker = 0; worker < workers; ++worker)
    threads.emplace_back([&, worker] {
      std::uint64_t word = 0;
      std::uint64_t got = 0;
      for (std::uint64_t pushed = 0; pushed < each; ++pushed) {
        queue->push(worker, word);
        for (int tries = 0; tries < 2; ++tries) got += queue->pop(worker, word) ? 1 : 0;
      }
      popped += got;
    });
  for (std::thread& thread : threads) thread.join();
  std::uint64_t word = 0;
  std::uint64_t left = 0;
  while (queue->pop(0, word)) ++left;
  EXPECT_EQ(popped + left, workers * each);
}

INSTANTIATE_TEST_SUITE_P(All, Counters, testing::Values("faa", "cas"));

TEST(NoQueue, answers_yes_to_everything) {
  const auto queue = counter("delay").make_word_queue(1, 1);
  std::uint64_t word = 7;
  EXPECT_TRUE(queue->pop(0, word));
  EXPECT_TRUE(queue->push(0, 1));
  EXPECT_EQ(word, 7U);
}

}  // namespace
}  // namespace irt
