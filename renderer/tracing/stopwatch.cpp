#include "renderer/tracing/stopwatch.hpp"

#include <algorithm>
#include <chrono>
#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace irt {
namespace {

using Clock = std::chrono::steady_clock;

#if defined(__x86_64__)
double measure_tick() {
  const auto start = Clock::now();
  const std::uint64_t first = ticks_now();
  auto now = start;
  while (now - start < std::chrono::milliseconds(2)) now = Clock::now();
  const std::uint64_t last = ticks_now();
  return std::chrono::duration<double, std::nano>(now - start).count() /
         static_cast<double>(last - first);
}
#endif

std::uint64_t measure_nothing() {
  std::uint64_t least = ~std::uint64_t{0};
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t first = ticks_now();
    least = std::min(least, ticks_now() - first);
  }
  return least;
}

}  // namespace

std::uint64_t ticks_now() {
#if defined(__x86_64__)
  return __rdtsc();
#else
  return static_cast<std::uint64_t>(
      std::chrono::nanoseconds(Clock::now().time_since_epoch()).count());
#endif
}

double nanoseconds_per_tick() {
#if defined(__x86_64__)
  static const double nanoseconds = measure_tick();
  return nanoseconds;
#else
  return 1.0;
#endif
}

std::uint64_t ticks_of_nothing() {
  static const std::uint64_t nothing = measure_nothing();
  return nothing;
}

}  // namespace irt
