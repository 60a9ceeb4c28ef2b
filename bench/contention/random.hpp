/// Random numbers that are the same for the same seed, everywhere.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

namespace irt::contention {

/// A random number from one word of state, which may start anywhere (Steele, Lea and Flood 2014,
/// SplitMix).
inline std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

/// Puts `values` into an order drawn from `state` (Fisher and Yates).
template <class T>
void shuffle(std::span<T> values, std::uint64_t& state) {
  for (std::size_t left = values.size(); left > 1; --left) {
    std::swap(values[left - 1], values[next_random(state) % left]);
  }
}

}  // namespace irt::contention
