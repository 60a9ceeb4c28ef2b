#include "bench/statistics/averages.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>
#include <numeric>

namespace irt::statistics {
namespace {

/// How many standard errors reach from a mean of `count` values to an end of its interval.
double reach(double count) {
  return boost::math::quantile(boost::math::students_t(count - 1), 0.975);
}

}  // namespace

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  return boost::math::statistics::median(values);
}

double quantile(std::vector<double> values, double q) {
  std::ranges::sort(values);
  const double at = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (values[above] - values[below]) * (at - static_cast<double>(below));
}

std::optional<double> half_interval(std::span<const double> values) {
  if (values.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(values.size());
  const double middle = mean(values);
  double squares = 0;
  for (const double value : values) squares += (value - middle) * (value - middle);
  return reach(count) * std::sqrt(squares / (count - 1) / count);
}

double half_interval(double deviation, std::size_t count) {
  const auto n = static_cast<double>(count);
  return reach(n) * deviation / std::sqrt(n);
}

std::optional<Interval> student_interval(std::span<const double> values) {
  const std::optional<double> half = half_interval(values);
  if (!half) return std::nullopt;
  return Interval{mean(values) - *half, mean(values) + *half};
}

Interval median_interval(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  const double reach = std::min(0.98 * std::sqrt(count) / count, 0.5);
  return {quantile(values, 0.5 - reach), quantile(values, 0.5 + reach)};
}

}  // namespace irt::statistics
