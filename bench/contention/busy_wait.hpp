/// Work between operations: a busy wait that lasts as long as it was asked to.
///
/// A wait is a number of steps of a chain of multiplications in which each needs the one before, so
/// that a step takes the same time wherever the loop is inlined. Fences keep the processor from
/// running operations, or the next wait, in its shadow: without them, waits of 100 ns in a row take
/// 60 each. How long a step and the fences take is measured against the clock, not assumed.
#pragma once

#include <algorithm>
#include <cstdint>

#include "queues/split_mix.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace irt::contention {

/// Nothing behind starts before everything ahead has been executed.
inline void execution_fence() {
#if defined(__x86_64__)
  _mm_lfence();
#elif defined(__aarch64__)
  asm volatile("dsb nshld\n\tisb" ::: "memory");
#endif
}

/// Waits for `steps` steps; not at all for none. Touches no memory.
[[gnu::always_inline]] inline void busy_wait(std::uint64_t steps) {
  if (steps == 0) return;
  execution_fence();
  std::uint64_t x = steps;
  for (; steps > 0; --steps) {
    x = x * 6364136223846793005U + 1442695040888963407U;
    asm volatile("" : "+r"(x));  // or the compiler would drop a chain whose end nobody reads
  }
  execution_fence();
}

/// What a wait takes: so much in any case, and so much for each step.
struct Pace {
  double fixed_ns = 0, step_ns = 1;
};

/// Takes some ten milliseconds. From the shortest of many rounds, since whatever disturbs a round
/// lengthens it.
Pace measure_pace();

/// Steps that take `nanoseconds` (not negative), to the nearest step; at least one, but none for
/// nothing.
inline std::uint64_t steps_for(double nanoseconds, const Pace& pace) {
  if (nanoseconds <= 0) return 0;
  return static_cast<std::uint64_t>(
      std::max(1.0, (nanoseconds - pace.fixed_ns) / pace.step_ns + 0.5));
}

/// Nanoseconds that a wait of `steps` does take, the call included; the shortest of many rounds.
double measure_wait_ns(std::uint64_t steps);

/// The waits of one thread: all alike, or spread evenly around their mean.
class Waits {
 public:
  /// `mean` steps, plus or minus `spread` (in [0, 1]) of them at random.
  Waits(std::uint64_t mean, double spread, std::uint64_t seed)
      : half_(static_cast<std::uint64_t>(static_cast<double>(mean) * spread)),
        least_(mean - half_),
        random_(seed) {}

  std::uint64_t next() { return half_ == 0 ? least_ : least_ + random_.below(2 * half_ + 1); }

 private:
  std::uint64_t half_, least_;
  SplitMix random_;
};

}  // namespace irt::contention
