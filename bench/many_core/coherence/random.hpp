/// The seeded randomness of a run.
#pragma once

#include <cstdint>

namespace irt::many_core {

/// Marsaglia's xorshift (2003).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}

  std::uint64_t next() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 7U;
    state_ ^= state_ << 17U;
    return state_;
  }

 private:
  std::uint64_t state_;
};

}  // namespace irt::many_core
