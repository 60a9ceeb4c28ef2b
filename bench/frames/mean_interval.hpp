/// Means with their intervals.
#pragma once

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <optional>
#include <span>

namespace irt {

struct MeanInterval {
  double mean = 0;
  std::optional<double> low, high;  ///< nothing for fewer than two samples
};

/// Half the width of the 95 % interval of a mean of `count` samples, at least 2, whose sample
/// standard deviation is `deviation` (Student's t).
inline double half_interval(double deviation, std::size_t count) {
  const boost::math::students_t t(static_cast<double>(count) - 1);
  return boost::math::quantile(t, 0.975) * deviation / std::sqrt(static_cast<double>(count));
}

/// The mean of `samples`, at least one, with its 95 % interval (Student's t).
inline MeanInterval mean_interval(std::span<const double> samples) {
  const auto count = static_cast<double>(samples.size());
  MeanInterval result;
  for (const double sample : samples) result.mean += sample / count;
  if (samples.size() < 2) return result;
  double squares = 0;
  for (const double sample : samples) squares += (sample - result.mean) * (sample - result.mean);
  const double half = half_interval(std::sqrt(squares / (count - 1)), samples.size());
  result.low = result.mean - half;
  result.high = result.mean + half;
  return result;
}

}  // namespace irt
