/// How long many short things took: a count per bucket, the buckets growing with the time.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace irt {

/// Four buckets to each doubling, so that a quantile is exact to about an eighth. Unlike a mean it
/// does not care that a thread lost its core in the middle of one operation.
class TimeHistogram {
 public:
  static constexpr std::size_t buckets = 160;  ///< up to 2^41 ns, some 37 minutes

  void add(std::uint64_t ns) { ++counts[bucket(ns)]; }

  TimeHistogram& operator+=(const TimeHistogram& other) {
    for (std::size_t i = 0; i < buckets; ++i) counts[i] += other.counts[i];
    return *this;
  }

  /// The time in nanoseconds below which a share `q` in [0, 1] of all lies; 0 if there are none.
  double quantile(double q) const {
    std::uint64_t all = 0, seen = 0;
    for (const std::uint64_t count : counts) all += count;
    for (std::size_t i = 0; i < buckets; ++i) {
      seen += counts[i];
      if (seen != 0 && static_cast<double>(seen) >= q * static_cast<double>(all)) {
        return 0.5 * static_cast<double>(lower_bound(i) + lower_bound(i + 1) - 1);
      }
    }
    return 0;
  }

  std::array<std::uint64_t, buckets> counts{};

 private:
  static constexpr std::size_t bucket(std::uint64_t ns) {
    if (ns < 4) return ns;
    const auto top = static_cast<std::size_t>(std::bit_width(ns)) - 1;
    const std::size_t index = 4 * (top - 1) + (ns >> (top - 2) & 3u);
    return index < buckets ? index : buckets - 1;
  }
  static constexpr std::uint64_t lower_bound(std::size_t index) {
    return index < 4 ? index : std::uint64_t{4 + index % 4} << (index / 4 - 1);
  }
};

}  // namespace irt
