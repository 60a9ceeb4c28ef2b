/// Vector clocks over the threads of an execution.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace irt::checker {

/// Threads of one execution, the one that prepares and finishes included.
inline constexpr unsigned max_threads = 16;

/// For each thread, how many of its events are within the past that the clock describes.
struct alignas(32) Clock {
  std::array<std::uint16_t, max_threads> count{};

  void join(const Clock& other) {
    for (std::size_t i = 0; i < max_threads; ++i)
      count[i] = count[i] < other.count[i] ? other.count[i] : count[i];
  }
};

}  // namespace irt::checker
