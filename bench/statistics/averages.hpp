/// What lies in the middle of repeated measurements, and how surely.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace irt::statistics {

/// Where a mean, a median or a ratio lies with a confidence of 95 per cent.
struct Interval {
  double low = 0, high = 0;
};

/// Of `values`, not empty.
double mean(std::span<const double> values);

/// Of `values`, not empty; between the two in the middle where their number is even.
double median(std::vector<double> values);

/// The value below which a share `q` in [0, 1] of `values` lies, interpolated; `values` not empty.
double quantile(std::vector<double> values, double q);

/// Half the width of the interval of the mean of normally distributed values (Student 1908).
/// Nothing for fewer than two.
std::optional<double> half_interval(std::span<const double> values);

/// The same of `count` values, at least two, of which the sample standard deviation is known.
double half_interval(double deviation, std::size_t count);

/// The interval of their mean; nothing for fewer than two.
std::optional<Interval> student_interval(std::span<const double> values);

/// The interval of the median of `values`, not empty, however they are distributed: the order
/// statistics that enclose it, in the normal approximation of the sign test.
Interval median_interval(const std::vector<double>& values);

}  // namespace irt::statistics
