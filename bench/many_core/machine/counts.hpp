/// What is counted of a run.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "bench/many_core/coherence/events.hpp"

namespace irt::many_core {

/// What a thread does with its time besides running.
enum class Cause : std::uint8_t {
  transfer,   ///< a line is on its way
  queueing,   ///< other cores are served first
  stores,     ///< earlier stores must be done before this operation
  spinning,   ///< asleep in a loop that looks at the same lines again and again
  parked,     ///< asleep in the kernel, and being woken
  scheduler,  ///< other threads have the core
};
inline constexpr std::size_t causes = 6;

constexpr std::string_view name_of(Cause cause) {
  constexpr std::array<std::string_view, causes> names{"transfer", "queueing", "stores",
                                                       "spinning", "parked",   "scheduler"};
  return names[static_cast<std::size_t>(cause)];
}

/// What happened in the measured part of a run.
struct Counts {
  std::uint64_t accesses = 0;      ///< to memory that threads share
  std::uint64_t transfers = 0;     ///< lines that moved
  std::uint64_t swaps = 0;         ///< compare-and-swaps that succeeded
  std::uint64_t failed_swaps = 0;  ///< and that did not
  std::uint64_t sleeps = 0;        ///< waits in the kernel
  std::array<Time, causes> waited{};
};

/// The measured part of a run.
struct Measurement {
  /// Who has not returned so long after its end is late.
  static constexpr Time patience = 20'000'000 * nanosecond;

  Time begin = 0, end = 0;
  Counts counts;

  [[nodiscard]] bool covers(Time time) const { return time >= begin && time <= end; }
  [[nodiscard]] Time limit() const { return end + patience; }
  void note_wait(Cause cause, Time from, Time to) {
    counts.waited[static_cast<std::size_t>(cause)] +=
        std::max<Time>(0, std::min(to, end) - std::max(from, begin));
  }
};

}  // namespace irt::many_core
