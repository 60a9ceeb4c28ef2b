/// Counts of durations, exact to better than one per cent.
///
/// Recording costs a few instructions and never allocates. Each thread has its own; they are merged
/// when all have stopped.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "renderer/engine/log_buckets.hpp"

namespace irt::contention {

class Histogram : public LogBuckets<7> {
 public:
  Histogram() : counts_(size) {}

  void record(std::uint64_t value) {
    ++counts_[index_of(value)];
    largest_ = std::max(largest_, value);
  }

  void merge(const Histogram& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    largest_ = std::max(largest_, other.largest_);
  }

  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counts_) sum += count;
    return sum;
  }

  /// The largest value, exactly.
  [[nodiscard]] std::uint64_t max() const { return largest_; }

  /// The value that a share `q` (in [0, 1]) of all does not exceed: the upper end of its bucket,
  /// never above `max()`. 0 where nothing was recorded.
  [[nodiscard]] std::uint64_t quantile(double q) const {
    const std::uint64_t all = count();
    const auto wanted = static_cast<std::uint64_t>(q * static_cast<double>(all) + 0.999999);
    const std::uint64_t rank =
        std::clamp<std::uint64_t>(wanted, 1, std::max<std::uint64_t>(all, 1));
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      sum += counts_[i];
      if (sum >= rank) return std::min(upper_end(i), largest_);
    }
    return 0;
  }

  /// The buckets that are not empty, by index, for a file; `add` takes them back.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::uint64_t>> buckets() const {
    std::vector<std::pair<std::size_t, std::uint64_t>> filled;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] != 0) filled.emplace_back(i, counts_[i]);
    }
    return filled;
  }
  void add(const std::vector<std::pair<std::size_t, std::uint64_t>>& buckets,
           std::uint64_t largest) {
    for (const auto& [index, count] : buckets) counts_.at(index) += count;
    largest_ = std::max(largest_, largest);
  }

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t largest_ = 0;
};

}  // namespace irt::contention
