/// The rings of `LinkedRings` one step at a time; what any queue must do is asked by the other
/// tests.
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "queues/lock_free/faa_array_queue.hpp"
#include "queues/lock_free/lcrq.hpp"
#include "queues/lock_free/lprq.hpp"
#include "queues/lock_free/lscq.hpp"

namespace irt {
namespace {

constexpr unsigned me = 0;

/// Rings whose places are used again and again.
template <class Ring>
class Rings : public testing::Test {};
using AllRings = testing::Types<ClosableRing<CrqPlace>, ClosableRing<PrqPlace>, ClosableScq>;
TYPED_TEST_SUITE(Rings, AllRings, );

TYPED_TEST(Rings, close_when_full_and_keep_what_they_have) {
  TypeParam ring(3, 1);
  for (std::uint64_t word = 1; word <= 8; ++word) ASSERT_TRUE(ring.put(me, word));
  EXPECT_FALSE(ring.put(me, 9));
  std::uint64_t word = 77;
  for (std::uint64_t expected = 1; expected <= 8; ++expected) {
    ASSERT_TRUE(ring.take(me, word));
    EXPECT_EQ(word, expected);
    EXPECT_FALSE(ring.put(me, 10)) << "closed for good";
  }
  EXPECT_FALSE(ring.take(me, word));
  EXPECT_FALSE(ring.take_rest(me, word));
}

// Every size has its own way from ticket to place; each must lead to all places.
TYPED_TEST(Rings, go_round_at_every_size) {
  for (unsigned bits = 1; bits <= 7; ++bits) {
    TypeParam ring(bits, 1);
    const std::uint64_t most = std::uint64_t{1} << bits;
    std::uint64_t pushed = 0;
    std::uint64_t popped = 0;
    for (int round = 0; round < 5; ++round) {
      while (pushed - popped < most) ASSERT_TRUE(ring.put(me, ++pushed)) << most << " places";
      for (std::uint64_t word = 0; popped < pushed;) {
        ASSERT_TRUE(ring.take(me, word));
        ASSERT_EQ(word, ++popped);
      }
    }
  }
}

// Pops of an empty ring use up tickets; the next push must not pay for them.
TYPED_TEST(Rings, stay_open_however_often_they_are_found_empty) {
  TypeParam ring(1, 1);
  std::uint64_t word = 0;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    for (int tries = 0; tries < 7; ++tries) ASSERT_FALSE(ring.take(me, word));
    ASSERT_TRUE(ring.put(me, i));
    ASSERT_TRUE(ring.take(me, word));
    ASSERT_EQ(word, i);
  }
}

TYPED_TEST(Rings, begin_with_a_first_word) {
  TypeParam ring(2, 1);
  ring.put_first(5);
  ASSERT_TRUE(ring.put(me, 6));
  std::uint64_t word = 0;
  ASSERT_TRUE(ring.take(me, word));
  EXPECT_EQ(word, 5U);
  ASSERT_TRUE(ring.take(me, word));
  EXPECT_EQ(word, 6U);
  EXPECT_FALSE(ring.take(me, word));
}

TEST(UsedOnceArray, is_used_up_by_as_many_pushes_as_it_has_places) {
  for (unsigned bits = 1; bits <= 7; ++bits) {
    UsedOnceArray array(bits, 1);
    array.put_first(1);
    const std::uint64_t most = std::uint64_t{1} << bits;
    std::uint64_t word = 0;
    for (std::uint64_t i = 1; i < most; ++i) {
      ASSERT_TRUE(array.put(me, i + 1));
      ASSERT_TRUE(array.take(me, word));
      ASSERT_EQ(word, i);
    }
    EXPECT_FALSE(array.put(me, 77));
    ASSERT_TRUE(array.take(me, word));
    EXPECT_EQ(word, most);
    EXPECT_FALSE(array.take(me, word));
  }
}

TEST(Scq, has_a_place_for_each_worker_at_least) {
  Scq<std::uint64_t> queue(5, 1);
  for (std::uint64_t i = 0; i < 8; ++i) EXPECT_TRUE(queue.push(me, i));
  EXPECT_FALSE(queue.push(me, 8));
  std::uint64_t word = 77;
  for (std::uint64_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(queue.pop(me, word));
    EXPECT_EQ(word, i);
  }
  EXPECT_FALSE(queue.pop(me, word));
}

/// Queues of rings.
template <class Queue>
class QueuesOfRings : public testing::Test {};
using AllQueuesOfRings = testing::Types<Lcrq<std::uint64_t>, Lprq<std::uint64_t>,
                                        Lscq<std::uint64_t>, FaaArrayQueue<std::uint64_t>>;
TYPED_TEST_SUITE(QueuesOfRings, AllQueuesOfRings, );

// With two places and more threads, tickets are spoilt, places made unsafe and rings left all the
// time; each producer's words must still come out in order.
TYPED_TEST(QueuesOfRings, keep_each_producers_order_over_many_rings) {
  constexpr unsigned producers = 3;
  constexpr std::uint64_t each = 20'000;
  TypeParam queue(producers + 1, 2);
  std::vector<std::thread> threads;
  for (unsigned worker = 0; worker < producers; ++worker)
    threads.emplace_back([&queue, worker] {
      for (std::uint64_t i = 1; i <= each; ++i) queue.push(worker, worker + producers * i);
    });
  std::vector<std::uint64_t> next(producers, 1);
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
