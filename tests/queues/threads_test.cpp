/// A short meeting of several threads: every element leaves exactly once, and in the order its
/// queue claims as far as one thread can tell. What takes luck to meet is for stress/ to find.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include "tests/queues/every_queue.hpp"

namespace irt {
namespace {

using Threads = EveryQueue;

constexpr unsigned shift = 32;  // an element is its producer, from 1 on, above its number

std::uint64_t worker_of(std::uint64_t word) {
  return (word >> shift) - 1;
}

struct Seen {
  std::vector<std::uint64_t> words;  // in the order one consumer took them
  std::uint64_t pushed = 0;
};

/// `producers` and `consumers` are counts of workers; worker w both pushes and pops if w is below
/// both. Each pushes `each` elements, or fewer where that takes long: rings that spin crawl once a
/// thread that others wait for is not running. Returns what each worker popped.
std::vector<Seen> meet(AnyWorkQueue<std::uint64_t>& queue, unsigned producers, unsigned consumers,
                       std::uint64_t each) {
  const unsigned workers = std::max(producers, consumers);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point deadline = Clock::now() + std::chrono::seconds(2);
  std::atomic<std::uint64_t> total{producers * each};
  std::atomic<std::uint64_t> popped{0};
  std::atomic<unsigned> ready{0};
  std::vector<Seen> seen(workers);
  std::vector<std::thread> threads;
  for (unsigned worker = 0; worker < workers; ++worker)
    threads.emplace_back([&, worker] {
      ++ready;
      while (ready < workers) std::this_thread::yield();
      std::uint64_t mine = worker < producers ? each : 0;
      std::uint64_t& pushed = seen[worker].pushed;
      while (pushed < mine || (worker < consumers && popped < total)) {
        bool idle = true;
        if (pushed < mine && Clock::now() > deadline) {
          total -= mine - pushed;
          mine = pushed;
        }
        // Bursts, so that the queue is now empty and now long.
        for (int burst = 0; burst < 7 && pushed < mine; ++burst)
          if (queue.push(worker, std::uint64_t{worker + 1} << shift | pushed)) {
            ++pushed;
            idle = false;
          }
        std::uint64_t word = 0;
        for (int burst = 0; burst < 7 && worker < consumers && queue.pop(worker, word); ++burst) {
          seen[worker].words.push_back(word);
          ++popped;
          idle = false;
        }
        if (idle) std::this_thread::yield();
      }
    });
  for (std::thread& thread : threads) thread.join();
  return seen;
}

void expect_each_once(const std::vector<Seen>& seen, unsigned producers) {
  std::vector<std::vector<unsigned>> times;
  for (unsigned worker = 0; worker < producers; ++worker)
    times.emplace_back(seen[worker].pushed, 0);
  for (const Seen& mine : seen)
    for (const std::uint64_t word : mine.words) {
      const std::uint64_t worker = worker_of(word);
      ASSERT_LT(worker, producers) << "never pushed";
      ASSERT_LT(word & 0xffff'ffff, seen[worker].pushed) << "never pushed";
      ++times[worker][word & 0xffff'ffff];
    }
  for (const auto& of_producer : times)
    for (const unsigned count : of_producer) ASSERT_EQ(count, 1U) << "lost or doubled";
}

void expect_producer_order(const std::vector<Seen>& seen, unsigned producers) {
  for (const Seen& mine : seen) {
    std::vector<std::uint64_t> next(producers, 0);
    for (const std::uint64_t word : mine.words) {
      std::uint64_t& least = next[worker_of(word)];
      ASSERT_GE(word & 0xffff'ffff, least) << "overtaken";
      least = (word & 0xffff'ffff) + 1;
    }
  }
}

void check(const QueueEntry& entry, unsigned producers, unsigned consumers, std::size_t capacity) {
  constexpr std::uint64_t each = 50'000;
  const auto queue = entry.make_word_queue(std::max(producers, consumers), capacity);
  const std::vector<Seen> seen = meet(*queue, producers, consumers, each);
  constexpr std::uint64_t least = 100;
  for (unsigned worker = 0; worker < producers; ++worker)
    EXPECT_GE(seen[worker].pushed, least) << "push refuses, or takes seconds";
  expect_each_once(seen, producers);
  const Ordering ordering = entry.claims.ordering;
  if (ordering != Ordering::unordered && ordering != Ordering::k_relaxed_fifo)
    expect_producer_order(seen, producers);
  std::uint64_t word = 0;
  for (unsigned worker = 0; worker < consumers; ++worker) EXPECT_FALSE(queue->pop(worker, word));
}

bool sees_only_its_own(const QueueEntry& entry) {
  return entry.claims.empty == Answer::this_worker;
}

TEST_P(Threads, all_push_and_pop) {
  if (GetParam().claims.producers == Callers::one || GetParam().claims.consumers == Callers::one)
    GTEST_SKIP() << "claims one caller at a time";
  check(GetParam(), 4, 4, 4096);
}

// A small capacity keeps a bounded queue full and makes hazard pointers scan at almost every pop.
TEST_P(Threads, all_push_and_pop_with_little_room) {
  if (GetParam().claims.producers == Callers::one || GetParam().claims.consumers == Callers::one)
    GTEST_SKIP() << "claims one caller at a time";
  check(GetParam(), 3, 3, 2);
}

TEST_P(Threads, many_push_one_pops) {
  if (GetParam().claims.producers != Callers::many) GTEST_SKIP() << "claims fewer producers";
  if (sees_only_its_own(GetParam())) GTEST_SKIP() << "a worker may see nothing of the others'";
  check(GetParam(), 4, 1, 64);
}

TEST_P(Threads, one_pushes_many_pop) {
  if (GetParam().claims.consumers != Callers::many) GTEST_SKIP() << "claims fewer consumers";
  check(GetParam(), 1, 4, 64);
}

TEST_P(Threads, one_pushes_one_pops) {
  if (GetParam().claims.consumers == Callers::own_worker)
    GTEST_SKIP() << "each worker has a queue of its own";
  check(GetParam(), 1, 1, 64);
}

// The renderer's use: the application deals for all workers, then the workers take over.
TEST_P(Threads, a_dealer_hands_over) {
  constexpr unsigned workers = 3;
  const auto queue = GetParam().make_word_queue(workers, 1024);
  for (int frame = 0; frame < 50; ++frame) {
    for (std::uint64_t word = 1; word <= 300; ++word)
      ASSERT_TRUE(queue->push(static_cast<unsigned>(word % workers), word));
    std::vector<std::uint64_t> sums(workers, 0);
    std::atomic<unsigned> left{300};
    std::vector<std::thread> threads;
    const unsigned poppers = GetParam().claims.consumers == Callers::one ? 1 : workers;
    for (unsigned worker = 0; worker < poppers; ++worker)
      threads.emplace_back([&, worker] {
        std::uint64_t word = 0;
        while (left > 0)
          if (queue->pop(worker, word)) {
            sums[worker] += word;
            --left;
          }
      });
    for (std::thread& thread : threads) thread.join();
    std::uint64_t sum = 0;
    for (const std::uint64_t of_worker : sums) sum += of_worker;
    ASSERT_EQ(sum, 300U * 301U / 2);
  }
}

IRT_FOR_EVERY_QUEUE(Threads);

}  // namespace
}  // namespace irt
