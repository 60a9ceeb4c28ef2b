/// What one thread can see of a queue: order, *empty*, *full*, claims that make sense.
#include <cstdint>
#include <deque>
#include <random>
#include <set>

#include "tests/queues/every_queue.hpp"

namespace irt {
namespace {

using Semantics = EveryQueue;

TEST_P(Semantics, is_described) {
  const QueueEntry& queue = GetParam();
  EXPECT_FALSE(queue.summary.empty());
  EXPECT_EQ(queue.summary.find('\n'), std::string_view::npos);
  EXPECT_LE(queue.summary.size(), 80U);
}

TEST_P(Semantics, claims_do_not_contradict_each_other) {
  const Claims& claims = GetParam().claims;
  EXPECT_EQ(claims.relaxation != 0, claims.ordering == Ordering::k_relaxed_fifo);
  EXPECT_EQ(claims.producers == Callers::own_worker, claims.consumers == Callers::own_worker);
  EXPECT_TRUE(claims.reclamation != Reclamation::preallocated || claims.bounded)
      << "who never allocates must be full at some time";
}

TEST_P(Semantics, pop_of_an_empty_queue_leaves_its_argument_alone) {
  const auto queue = GetParam().make_word_queue(2, 8);
  std::uint64_t word = 77;
  EXPECT_FALSE(queue->pop(0, word));
  EXPECT_EQ(word, 77U);
  ASSERT_TRUE(queue->push(0, 5));
  ASSERT_TRUE(queue->pop(0, word));
  EXPECT_EQ(word, 5U);
  EXPECT_FALSE(queue->pop(0, word));
  EXPECT_EQ(word, 5U);
}

// One worker alone must see first-in, first-out under every ordering but the relaxed ones.
TEST_P(Semantics, one_worker_sees_the_model) {
  const Claims& claims = GetParam().claims;
  const bool fifo =
      claims.ordering != Ordering::unordered && claims.ordering != Ordering::k_relaxed_fifo;
  constexpr std::size_t capacity = 300;
  const auto queue = GetParam().make_word_queue(1, capacity);
  std::deque<std::uint64_t> in_order;
  std::multiset<std::uint64_t> held;
  std::mt19937 random(42);
  std::uint64_t next = 1;
  for (int step = 0; step < 20'000; ++step) {
    // Long phases that fill and phases that drain, so that both ends are met.
    const bool filling = step / 500 % 2 == 0;
    if (random() % 4 < (filling ? 3U : 1U)) {
      if (held.size() == capacity) continue;
      ASSERT_TRUE(queue->push(0, next)) << "held " << held.size() << " of " << capacity;
      in_order.push_back(next);
      held.insert(next++);
    } else {
      std::uint64_t word = 0;
      const bool found = queue->pop(0, word);
      ASSERT_EQ(found, !held.empty());
      if (!found) continue;
      if (fifo) {
        ASSERT_EQ(word, in_order.front());
        in_order.pop_front();
      }
      const auto one = held.find(word);
      ASSERT_NE(one, held.end()) << word << " was not in the queue";
      held.erase(one);
    }
  }
}

TEST_P(Semantics, holds_what_it_promised_and_is_full_only_if_bounded) {
  constexpr std::size_t capacity = 100;
  const auto queue = GetParam().make_word_queue(3, capacity);
  std::size_t held = 0;
  while (held < 100 * capacity && queue->push(1, held + 1)) ++held;
  if (GetParam().claims.bounded) {
    EXPECT_GE(held, capacity);
    EXPECT_LT(held, 100 * capacity) << "claims to be bounded";
    std::uint64_t word = 0;
    EXPECT_TRUE(queue->pop(1, word));
    EXPECT_TRUE(queue->push(1, 1)) << "full after one element has left";
  } else {
    EXPECT_EQ(held, 100 * capacity) << "claims to be unbounded";
  }
}

// Every bit of an element must survive that an element may have, and so must an address.
TEST_P(Semantics, keeps_every_bit) {
  const Claims& claims = GetParam().claims;
  const auto words = GetParam().make_word_queue(1, 8);
  const std::uint64_t used = ~claims.unused_bits;
  for (const std::uint64_t word :
       {std::uint64_t{0}, used, used - 1, std::uint64_t{1} << 63U, std::uint64_t{1} << 62U}) {
    if (!claims.allows(word)) continue;
    ASSERT_TRUE(words->push(0, word));
    std::uint64_t out = 123;
    ASSERT_TRUE(words->pop(0, out));
    EXPECT_EQ(out, word);
  }
  const auto tasks = GetParam().make_task_queue(1, 8);
  int thing = 0;
  for (void* task : {static_cast<void*>(&thing), static_cast<void*>(nullptr)}) {
    if (task == nullptr && !claims.allows(0)) continue;
    ASSERT_TRUE(tasks->push(0, task));
    void* out = this;
    ASSERT_TRUE(tasks->pop(0, out));
    EXPECT_EQ(out, task);
  }
}

// Leaks and double frees are the sanitizers' to see.
TEST_P(Semantics, can_be_destroyed_full_empty_or_in_between) {
  for (const unsigned pops : {0U, 5U, 99U, 100U}) {
    const auto queue = GetParam().make_word_queue(4, 100);
    for (unsigned i = 0; i < 100; ++i) ASSERT_TRUE(queue->push(i % 4, i + 1));
    std::uint64_t word = 0;
    for (unsigned i = 0; i < pops; ++i) ASSERT_TRUE(queue->pop(i % 4, word));
  }
}

TEST_P(Semantics, lives_with_the_smallest_capacity) {
  for (const std::size_t capacity : {std::size_t{0}, std::size_t{1}}) {
    const auto queue = GetParam().make_word_queue(1, capacity);
    for (std::uint64_t i = 1; i <= 100; ++i) {
      if (!queue->push(0, i)) {
        EXPECT_EQ(capacity, 0U);
        EXPECT_TRUE(GetParam().claims.bounded);
        break;
      }
      std::uint64_t word = 0;
      ASSERT_TRUE(queue->pop(0, word));
      EXPECT_EQ(word, i);
    }
  }
}

IRT_FOR_EVERY_QUEUE(Semantics);

}  // namespace
}  // namespace irt
