/// Random numbers that are the same for the same seed, everywhere.
#pragma once

#include <cstdint>

namespace irt {

/// SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators"): one
/// word of state, any seed will do. The library's distributions differ between systems, so those
/// that are needed stand here. Frames, histories and schedules rest on every bit.
class SplitMix {
 public:
  explicit constexpr SplitMix(std::uint64_t seed) : state_(seed) {}

  constexpr std::uint64_t next() { return mixed(state_ += step); }

  /// Below `limit`, which is at least 1.
  constexpr std::uint64_t below(std::uint64_t limit) { return next() % limit; }

  /// Uniform in [0, 1).
  constexpr float uniform() { return static_cast<float>(next() >> 40) * 0x1p-24f; }

  /// The `number`-th, from 1, of those whose seed is 0.
  static constexpr std::uint64_t at(std::uint64_t number) { return mixed(number * step); }

  /// Words that differ in any bit differ in about half of them.
  static constexpr std::uint64_t mixed(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58'476d'1ce4'e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d0'49bb'1331'11ebu;
    return bits ^ (bits >> 31);
  }

 private:
  static constexpr std::uint64_t step = 0x9e37'79b9'7f4a'7c15u;

  std::uint64_t state_;
};

}  // namespace irt
