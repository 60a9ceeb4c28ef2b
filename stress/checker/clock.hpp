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
    // All at once: it is what the checker does most, and loops so short stay loops at -O2.
    using All = std::uint16_t __attribute__((vector_size(sizeof count), may_alias));
    auto& mine = reinterpret_cast<All&>(count);
    const auto& theirs = reinterpret_cast<const All&>(other.count);
    mine = mine < theirs ? theirs : mine;
  }
};

}  // namespace irt::checker
