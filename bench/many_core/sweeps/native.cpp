#include "bench/many_core/sweeps/native.hpp"

#include <atomic>
#include <chrono>
#include <sched.h>
#include <thread>

#include "bench/contention/busy_wait.hpp"
#include "queues/cache_line.hpp"

namespace irt::many_core {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
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
  const std::uint64_t steps = contention::steps_for(work_ns, contention::measure_pace());
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
        const ActsFor leaves(*words, worker);
        ++ready;
        while (ready < threads) std::this_thread::yield();
        // relaxed: a hint
        while (!over.load(std::memory_order_relaxed)) {
          words->push(worker, worker + 1);
          contention::busy_wait(steps);
          std::uint64_t element = 0;
          // relaxed: a hint
          while (!words->pop(worker, element) && !over.load(std::memory_order_relaxed)) {
          }
          contention::busy_wait(steps);
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
