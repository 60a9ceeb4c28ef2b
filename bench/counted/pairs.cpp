#include "bench/counted/pairs.hpp"

#include <atomic>
#include <barrier>
#include <chrono>
#include <thread>

#include "queues/cache_line.hpp"
#include "queues/roles.hpp"

namespace irt {
namespace {

struct alignas(cache_line_pair) Seat {
  std::uint64_t operations = 0;
  std::uint64_t failed = 0;
  AtomicEvents events;
};

/// What `worker` may do of both, as long as it may.
void push_and_pop(AnyWorkQueue<std::uint64_t>& queue, const Claims& claims, const Roles& roles,
                  unsigned worker, const std::atomic<bool>& stop, Seat& seat) {
  constexpr std::uint64_t pairs_at_a_time = 64;  // between two looks at `stop`
  const bool pushes = roles.pushes(worker);
  const bool pops = roles.pops(worker);
  const std::uint64_t pushed = claims.some_word();
  std::uint64_t word = 0;
  std::uint64_t done = 0;
  std::uint64_t tried = 0;
  // relaxed: nothing but the flag itself is read
  while (!stop.load(std::memory_order_relaxed)) {
    for (std::uint64_t pair = 0; pair < pairs_at_a_time; ++pair) {
      if (pushes) done += queue.push(worker, pushed) ? 1 : 0;
      if (pops) done += queue.pop(worker, word) ? 1 : 0;
    }
    tried += (pushes ? pairs_at_a_time : 0) + (pops ? pairs_at_a_time : 0);
  }
  seat.operations = done;
  seat.failed = tried - done;
}

/// One round; returns successful operations per second.
double run(const QueueEntry& entry, const PairsOptions& options, Seat& sum) {
  using Clock = std::chrono::steady_clock;
  const auto queue = entry.make_word_queue(options.threads, 1024);
  const Roles roles = most_roles(entry.claims, options.threads);
  std::vector<Seat> seats(options.threads);
  std::atomic<bool> stop{false};
  std::barrier start(options.threads + 1);
  std::vector<std::thread> threads;
  for (unsigned worker = 0; worker < options.threads; ++worker)
    threads.emplace_back([&, worker] {
      start.arrive_and_wait();
      atomic_events() = {};
      const ActsFor leaves(*queue, worker);
      push_and_pop(*queue, entry.claims, roles, worker, stop, seats[worker]);
      seats[worker].events = atomic_events();
    });
  start.arrive_and_wait();
  const Clock::time_point begin = Clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(options.seconds));
  stop = true;
  const std::chrono::duration<double> passed = Clock::now() - begin;
  for (std::thread& thread : threads) thread.join();
  std::uint64_t operations = 0;
  for (const Seat& seat : seats) {
    operations += seat.operations;
    sum.failed += seat.failed;
    sum.events += seat.events;
  }
  sum.operations += operations;
  return static_cast<double>(operations) / passed.count();
}

}  // namespace

CountedPairs count_pairs(const QueueEntry& plain, const QueueEntry& counted,
                         const PairsOptions& options) {
  CountedPairs result;
  Seat ignored;
  Seat sum;
  for (unsigned round = 0; round < options.rounds; ++round) {
    result.plain_per_second.push_back(run(plain, options, ignored));
    result.counted_per_second.push_back(run(counted, options, sum));
  }
  result.operations = sum.operations;
  result.failed = sum.failed;
  result.events = sum.events;
  return result;
}

}  // namespace irt
