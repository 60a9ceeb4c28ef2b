#include "stress/history/clock.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <pthread.h>
#include <sched.h>
#include <thread>
#include <vector>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace irt::stress {
namespace {

/// Where the counter of another core may stand against ours, in ticks.
struct Offset {
  std::int64_t low = std::numeric_limits<std::int64_t>::min();
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
};

void pin(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(processor), &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

/// Our stamp, theirs, ours: theirs was made in between, so each exchange bounds the offset from
/// both sides. The tightest bounds of all exchanges hold together.
Offset measure(int here, int there) {
  constexpr int exchanges = 2'000;
  alignas(64) std::atomic<int> question{0};
  alignas(64) std::atomic<int> answer{0};
  Stamp their_stamp = 0;
  const auto wait_for = [](const std::atomic<int>& flag, int value) {
    for (int spins = 0; flag.load(std::memory_order_acquire) != value; ++spins) {
      if (spins % 4096 == 4095) std::this_thread::yield();
    }
  };
  std::thread peer([&] {
    pin(there);
    for (int i = 1; i <= exchanges; ++i) {
      wait_for(question, i);
      their_stamp = stamp_after();
      answer.store(i, std::memory_order_release);
    }
  });
  pin(here);
  Offset offset;
  for (int i = 1; i <= exchanges; ++i) {
    const auto before = static_cast<std::int64_t>(stamp_before());
    question.store(i, std::memory_order_release);
    wait_for(answer, i);
    const auto after = static_cast<std::int64_t>(stamp_after());
    const auto theirs = static_cast<std::int64_t>(their_stamp);
    offset.low = std::max(offset.low, theirs - after);
    offset.high = std::min(offset.high, theirs - before);
  }
  peer.join();
  return offset;
}

double measure_rate() {
  const auto start = std::chrono::steady_clock::now();
  const Stamp first = stamp_before();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const Stamp last = stamp_after();
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - start;
  return static_cast<double>(last - first) / passed.count();
}

}  // namespace

bool detail::invariant_counter() {
#if defined(__x86_64__)
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  constexpr unsigned invariant_bit = 1U << 8;
  return __get_cpuid(0x80000007U, &a, &b, &c, &d) != 0 && (d & invariant_bit) != 0;
#else
  return false;
#endif
}

ClockQuality calibrate() {
  if (!detail::use_counter) {
    return {.time_stamp_counter = false,
            .ticks_per_nanosecond = 1,
            .error = 0,
            .description =
                "stamps: CLOCK_MONOTONIC, because this processor does not promise an "
                "invariant time-stamp counter; intervals are wider and fewer "
                "violations of real-time order can be seen"};
  }
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed);
  std::vector<int> processors;
  for (int p = 0; p < CPU_SETSIZE; ++p) {
    if (CPU_ISSET(static_cast<unsigned>(p), &allowed)) processors.push_back(p);
  }
  ClockQuality quality;
  quality.time_stamp_counter = true;
  quality.ticks_per_nanosecond = measure_rate();
  for (std::size_t i = 1; i < processors.size(); ++i) {
    const Offset offset = measure(processors[0], processors[i]);
    quality.error = std::max(
        quality.error, static_cast<Stamp>(std::max(std::abs(offset.low), std::abs(offset.high))));
  }
  pthread_setaffinity_np(pthread_self(), sizeof allowed, &allowed);
  quality.description = fmt::format(
      "stamps: time-stamp counter, {:.2f} ticks/ns, {} cores apart by at most {:.0f} ns",
      quality.ticks_per_nanosecond, processors.size(),
      static_cast<double>(quality.error) / quality.ticks_per_nanosecond);
  return quality;
}

}  // namespace irt::stress
