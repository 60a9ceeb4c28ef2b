/// Work between operations: a busy wait that lasts as long as it was asked to.
///
/// A wait is a number of steps of a chain of multiplications in which each needs the one before, so
/// that a step takes the same time wherever the loop is inlined. How long a step takes is measured
/// against the clock, not assumed.
#pragma once

#include <cstdint>

namespace irt::contention {

/// Waits for `steps` steps. Touches no memory.
inline void busy_wait(std::uint64_t steps) {
  std::uint64_t x = steps;
  for (; steps > 0; --steps) {
    x = x * 6364136223846793005U + 1442695040888963407U;
    asm volatile("" : "+r"(x));  // or the compiler would drop a chain whose end nobody reads
  }
}

/// Nanoseconds per step. Takes some ten milliseconds. The shortest of many rounds, since whatever
/// disturbs a round lengthens it.
double measure_step_ns();

/// Steps that take `nanoseconds` (not negative), to the nearest step.
inline std::uint64_t steps_for(double nanoseconds, double step_ns) {
  return static_cast<std::uint64_t>(nanoseconds / step_ns + 0.5);
}

/// Nanoseconds that a wait of `steps` does take, the call included; the shortest of many rounds.
double measure_wait_ns(std::uint64_t steps);

/// A random number from one word of state, which may start anywhere (Steele, Lea and Flood 2014,
/// SplitMix).
inline std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

/// The waits of one thread: all alike, or spread evenly around their mean.
class Waits {
 public:
  /// `mean` steps, plus or minus `spread` (in [0, 1]) of them at random.
  Waits(std::uint64_t mean, double spread, std::uint64_t seed)
      : half_(static_cast<std::uint64_t>(static_cast<double>(mean) * spread)),
        least_(mean - half_),
        random_(seed) {}

  std::uint64_t next() {
    return half_ == 0 ? least_ : least_ + next_random(random_) % (2 * half_ + 1);
  }

 private:
  std::uint64_t half_, least_, random_;
};

}  // namespace irt::contention
