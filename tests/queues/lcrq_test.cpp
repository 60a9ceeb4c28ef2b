/// The rings of LCRQ one step at a time; what any queue must do is asked by the other tests.
#include "queues/lock_free/lcrq.hpp"

#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace irt {
namespace {

TEST(ClosableRing, closes_when_full_and_keeps_what_it_has) {
  ClosableRing ring(3);
  for (std::uint64_t word = 0; word < 8; ++word) ASSERT_TRUE(ring.put(word));
  EXPECT_FALSE(ring.put(8));
  std::uint64_t word = 77;
  for (std::uint64_t expected = 0; expected < 8; ++expected) {
    ASSERT_TRUE(ring.take(word));
    EXPECT_EQ(word, expected);
    EXPECT_FALSE(ring.put(9)) << "closed for good";
  }
  EXPECT_FALSE(ring.take(word));
}

// Every size has its own way from ticket to place; each must lead to all places.
TEST(ClosableRing, goes_round_at_every_size) {
  for (unsigned bits = 1; bits <= 7; ++bits) {
    ClosableRing ring(bits);
    const std::uint64_t most = std::uint64_t{1} << bits;
    std::uint64_t pushed = 0;
    std::uint64_t popped = 0;
    for (int round = 0; round < 5; ++round) {
      while (pushed - popped < most) ASSERT_TRUE(ring.put(pushed++)) << most << " places";
      for (std::uint64_t word = 0; popped < pushed; ++popped) {
        ASSERT_TRUE(ring.take(word));
        ASSERT_EQ(word, popped);
      }
    }
  }
}

// Pops of an empty ring use up tickets; the next push must not pay for them.
TEST(ClosableRing, stays_open_however_often_it_is_found_empty) {
  ClosableRing ring(1);
  std::uint64_t word = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    for (int tries = 0; tries < 7; ++tries) ASSERT_FALSE(ring.take(word));
    ASSERT_TRUE(ring.put(i));
    ASSERT_TRUE(ring.take(word));
    ASSERT_EQ(word, i);
  }
}

TEST(ClosableRing, begins_with_a_first_word) {
  ClosableRing ring(2);
  ring.put_first(5);
  ASSERT_TRUE(ring.put(6));
  std::uint64_t word = 0;
  ASSERT_TRUE(ring.take(word));
  EXPECT_EQ(word, 5U);
  ASSERT_TRUE(ring.take(word));
  EXPECT_EQ(word, 6U);
  EXPECT_FALSE(ring.take(word));
}

// With two places and more threads, tickets are spoilt, places made unsafe and rings left all the
// time; each producer's words must still come out in order.
TEST(Lcrq, keeps_each_producers_order_over_many_rings) {
  constexpr unsigned producers = 3;
  constexpr std::uint64_t each = 20'000;
  Lcrq<std::uint64_t> queue(producers + 1, 2);
  std::vector<std::thread> threads;
  for (unsigned worker = 0; worker < producers; ++worker)
    threads.emplace_back([&queue, worker] {
      for (std::uint64_t i = 0; i < each; ++i) queue.push(worker, worker + producers * i);
    });
  std::vector<std::uint64_t> next(producers, 0);
  for (std::uint64_t left = producers * each; left > 0;) {
    std::uint64_t word = 0;
    if (!queue.pop(producers, word)) continue;
    --left;
    EXPECT_EQ(word / producers, next[word % producers]++);
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace irt
