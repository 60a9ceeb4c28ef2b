/// How long many short things took: a count per bucket, the buckets growing with the time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "renderer/engine/log_buckets.hpp"

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
  [[nodiscard]] double quantile(double q) const {
    std::uint64_t all = 0, seen = 0;
    for (const std::uint64_t count : counts) all += count;
    for (std::size_t i = 0; i < buckets; ++i) {
      seen += counts[i];
      if (seen != 0 && static_cast<double>(seen) >= q * static_cast<double>(all)) {
        return 0.5 * static_cast<double>(Buckets::lower_end(i) + Buckets::upper_end(i));
      }
    }
    return 0;
  }

  std::array<std::uint64_t, buckets> counts{};

 private:
  using Buckets = LogBuckets<2>;

  static constexpr std::size_t bucket(std::uint64_t ns) {
    return std::min(Buckets::index_of(ns), buckets - 1);
  }
};

}  // namespace irt
