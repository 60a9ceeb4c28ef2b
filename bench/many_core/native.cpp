#include "bench/many_core/native.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <sched.h>
#include <thread>

#include "queues/cache_line.hpp"

namespace irt::many_core {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// A chain of multiplications that nothing can shorten.
void work(std::uint64_t steps) {
  std::uint64_t x = steps | 1U;
  for (std::uint64_t i = 0; i < steps; ++i) {
    x = x * 6364136223846793005U + 1;
    asm volatile("" : "+r"(x));
  }
}

double steps_per_ns() {
  constexpr std::uint64_t steps = 2'000'000;
  double best = 1e9;
  for (int i = 0; i < 7; ++i) {
    const auto begin = Clock::now();
    work(steps);
    best = std::min(best, seconds_since(begin));
  }
  return static_cast<double>(steps) / (best * 1e9);
}

void bind_to(unsigned number) {
  cpu_set_t all;
  if (sched_getaffinity(0, sizeof all, &all) != 0) return;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &all) || number-- != 0) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    sched_setaffinity(0, sizeof one, &one);
    return;
  }
}

struct alignas(cache_line_pair) Count {
  std::uint64_t operations = 0;
};

}  // namespace

std::vector<double> measure_pairs(const QueueEntry& queue, unsigned threads, double work_ns,
                                  double seconds, unsigned repetitions) {
  const auto steps = static_cast<std::uint64_t>(work_ns * steps_per_ns());
  std::vector<double> rates;
  for (unsigned repetition = 0; repetition < repetitions; ++repetition) {
    const auto words = queue.make_word_queue(threads, 65536);
    std::vector<Count> counts(threads);
    std::atomic<unsigned> ready{0};
    std::atomic<bool> over{false};
    std::vector<std::thread> team;
    for (unsigned worker = 0; worker < threads; ++worker) {
      team.emplace_back([&, worker] {
        bind_to(worker);
        ++ready;
        while (ready < threads) std::this_thread::yield();
        // relaxed: a hint
        while (!over.load(std::memory_order_relaxed)) {
          words->push(worker, worker + 1);
          work(steps);
          std::uint64_t element = 0;
          // relaxed: a hint
          while (!words->pop(worker, element) && !over.load(std::memory_order_relaxed)) {
          }
          work(steps);
          counts[worker].operations += 2;
        }
      });
    }
    while (ready < threads) std::this_thread::yield();
    const auto begin = Clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    over = true;
    for (std::thread& thread : team) thread.join();
    const double taken = seconds_since(begin);
    std::uint64_t operations = 0;
    for (const Count& count : counts) operations += count.operations;
    rates.push_back(static_cast<double>(operations) / taken);
  }
  return rates;
}

}  // namespace irt::many_core
