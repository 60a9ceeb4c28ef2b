/// Buckets for whole numbers, in HdrHistogram's scheme (Tene 2012): every power of two is divided
/// into as many equal ones.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace irt {

/// A value is off from the end of its bucket by less than one part in `precision` of itself; below
/// that many it is exact.
template <unsigned precision_bits>
struct LogBuckets {
  static constexpr std::uint64_t precision = 1U << precision_bits;
  static constexpr std::size_t size = (64 - precision_bits + 1) * precision;  ///< for any value

  static constexpr std::size_t index_of(std::uint64_t value) {
    if (value < precision) return value;
    const auto exponent = static_cast<unsigned>(std::bit_width(value)) - precision_bits - 1;
    return (std::size_t{exponent} << precision_bits) + (value >> exponent);
  }

  /// The largest value that falls into the bucket.
  static constexpr std::uint64_t upper_end(std::size_t index) {
    if (index < 2 * precision) return index;
    const std::size_t exponent = (index >> precision_bits) - 1;
    const std::uint64_t leading = index - (exponent << precision_bits);
    return (leading << exponent) + ((std::uint64_t{1} << exponent) - 1);
  }

  static constexpr std::uint64_t lower_end(std::size_t index) {
    return index == 0 ? 0 : upper_end(index - 1) + 1;
  }
};

}  // namespace irt
