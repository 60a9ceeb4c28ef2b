/// From samples to the figures that are reported.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/frames/sample.hpp"

namespace irt {

/// What all runs of one report have in common.
struct Background {
  WorkloadOptions workload;
  std::size_t triangles = 0;
  unsigned warmup = 0;
  double traverse_share = 0;  ///< see `traverse_share()`
  nlohmann::json conditions;
};

/// One object per queue and number of threads, in the order of their first samples. Speeds are
/// medians over all frames, with quartiles; `speed_up` is against the fastest run with one thread
/// and null without one. Times of the
/// queue are per task, in medians, 99th percentiles and means, with the cost of the clock taken
/// off.
nlohmann::ordered_json summarise(std::span<const Sample> samples, const Background& background);

/// The table that people read: one line per run.
std::string table(const nlohmann::ordered_json& runs);

/// One line per run under a line of names: all fields but the conditions.
std::string csv(const nlohmann::ordered_json& runs);

/// The value below which a share `q` in [0, 1] of `values` lies, interpolated; `values` not empty.
double quantile(std::vector<double> values, double q);

}  // namespace irt
