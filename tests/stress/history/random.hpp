/// Numbers for histories made at random.
#pragma once

#include <cstdint>
#include <random>

namespace irt::stress {

using Random = std::mt19937_64;

/// From 0 to `bound` - 1; not exactly uniform.
inline std::uint64_t below(Random& random, std::uint64_t bound) {
  return random() % bound;
}

}  // namespace irt::stress
