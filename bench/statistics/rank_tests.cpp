#include "bench/statistics/rank_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <map>
#include <numeric>

namespace irt::statistics {
namespace {

constexpr double level = 0.05;

/// How likely U is each of its values 0 ... n m where both sets come from the same distribution
/// (the recurrence of Mann and Whitney's section 3).
std::vector<double> null_distribution(std::size_t n, std::size_t m) {
  // ways[j][u]: arrangements of i values of one set and j of the other with so large a U.
  std::vector<std::vector<double>> ways(m + 1, std::vector<double>(n * m + 1));
  for (auto& row : ways) row[0] = 1;  // i = 0
  for (std::size_t i = 1; i <= n; ++i) {
    // The largest value belongs to the first set, and is above j others, or to the second.
    for (std::size_t j = 1; j <= m; ++j) {
      std::vector<double> next(n * m + 1);
      for (std::size_t u = 0; u <= i * j; ++u) {
        next[u] = (u >= j ? ways[j][u - j] : 0) + ways[j - 1][u];
      }
      ways[j] = std::move(next);
    }
  }
  std::vector<double> probability = ways[m];
  const double all = std::accumulate(probability.begin(), probability.end(), 0.0);
  for (double& one : probability) one /= all;
  return probability;
}

/// How likely the sum of the positive ranks is each of its values 0 ... n (n + 1) / 2 where each of
/// the ranks 1 ... n is positive or negative with the same chance.
std::vector<double> signed_null_distribution(std::size_t n) {
  std::vector<double> probability(n * (n + 1) / 2 + 1);
  probability[0] = 1;
  for (std::size_t rank = 1; rank <= n; ++rank) {
    for (std::size_t sum = rank * (rank + 1) / 2 + 1; sum-- > 0;) {
      probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
    }
  }
  return probability;
}

/// P(value <= u).
double lower_tail(const std::vector<double>& probability, double u) {
  double sum = 0;
  for (std::size_t i = 0; i < probability.size() && static_cast<double>(i) <= u; ++i) {
    sum += probability[i];
  }
  return sum;
}

double normal_p(double u, double n, double m, const std::map<double, std::size_t>& values) {
  double ties = 0;
  for (const auto& [value, count] : values) {
    const auto t = static_cast<double>(count);
    ties += t * t * t - t;
  }
  const double all = n + m;
  const double variance = n * m / 12 * (all + 1 - ties / (all * (all - 1)));
  const double distance = std::abs(u - n * m / 2) - 0.5;
  if (variance <= 0 || distance <= 0) return 1;
  return std::min(1.0, 2 * cdf(complement(boost::math::normal(), distance / std::sqrt(variance))));
}

/// The largest value of which at most the level is as far outside, on both sides together.
std::optional<std::size_t> critical(const std::vector<double>& probability) {
  double sum = 0;
  std::optional<std::size_t> found;
  for (std::size_t u = 0; u < probability.size(); ++u) {
    sum += probability[u];
    if (2 * sum > level) break;
    found = u;
  }
  return found;
}

/// The largest u with P(U <= u) + P(U >= n m - u) at most the level; nothing where there is none.
std::optional<std::size_t> critical(std::size_t n, std::size_t m) {
  if (n == 0 || m == 0) return std::nullopt;
  if (n > exact_limit || m > exact_limit) {
    const auto a = static_cast<double>(n), b = static_cast<double>(m);
    const double z = quantile(complement(boost::math::normal(), level / 2));
    return static_cast<std::size_t>(a * b / 2 - 0.5 - z * std::sqrt(a * b * (a + b + 1) / 12));
  }
  return critical(null_distribution(n, m));
}

/// The largest w with P(W <= w) + P(W >= n (n + 1) / 2 - w) at most the level.
std::optional<std::size_t> signed_critical(std::size_t n) {
  if (n <= exact_limit) return critical(signed_null_distribution(n));
  const auto count = static_cast<double>(n);
  const double z = quantile(complement(boost::math::normal(), level / 2));
  const double deviation = std::sqrt(count * (count + 1) * (2 * count + 1) / 24);
  return static_cast<std::size_t>(count * (count + 1) / 4 - 0.5 - z * deviation);
}

}  // namespace

RankTest mann_whitney(std::span<const double> a, std::span<const double> b) {
  RankTest test;
  if (a.empty() || b.empty()) return test;
  for (const double x : a) {
    for (const double y : b) test.u += x > y ? 1 : x == y ? 0.5 : 0;
  }
  std::map<double, std::size_t> values;
  for (const double x : a) ++values[x];
  for (const double y : b) ++values[y];
  const bool ties = values.size() < a.size() + b.size();
  const double n = static_cast<double>(a.size()), m = static_cast<double>(b.size());
  if (ties || a.size() > exact_limit || b.size() > exact_limit) {
    test.p = normal_p(test.u, n, m, values);
  } else {
    const double smaller = std::min(test.u, n * m - test.u);
    test.p = std::min(1.0, 2 * lower_tail(null_distribution(a.size(), b.size()), smaller));
  }
  return test;
}

Ratio ratio(std::span<const double> a, std::span<const double> b) {
  Ratio found;
  found.of_medians = median({b.begin(), b.end()}) / median({a.begin(), a.end()});
  const std::optional<std::size_t> excluded = critical(a.size(), b.size());
  if (!excluded) return found;
  std::vector<double> ratios;
  ratios.reserve(a.size() * b.size());
  for (const double x : a) {
    for (const double y : b) ratios.push_back(y / x);
  }
  std::ranges::sort(ratios);
  found.interval = {ratios[*excluded], ratios[ratios.size() - 1 - *excluded]};
  return found;
}

Difference judge(std::span<const double> a, std::span<const double> b) {
  if (!critical(a.size(), b.size())) return Difference::too_few;
  const RankTest test = mann_whitney(a, b);
  if (test.p >= level) return Difference::none;
  const bool mostly_larger = 2 * test.u < static_cast<double>(a.size() * b.size());
  return mostly_larger ? Difference::faster : Difference::slower;
}

double signed_rank_p(std::span<const double> differences) {
  std::map<double, std::size_t> magnitudes;
  for (const double one : differences) {
    if (one != 0) ++magnitudes[std::abs(one)];
  }
  std::map<double, double> ranks;
  double below = 0, ties = 0;
  for (const auto& [magnitude, count] : magnitudes) {
    const auto t = static_cast<double>(count);
    ranks[magnitude] = below + (t + 1) / 2;
    below += t;
    ties += t * t * t - t;
  }
  if (below == 0) return 1;
  double positive = 0;
  for (const double one : differences) {
    if (one > 0) positive += ranks[one];
  }
  const double n = below, all = n * (n + 1) / 2;
  const auto count = static_cast<std::size_t>(n);
  if (ties == 0 && count <= exact_limit) {
    const double smaller = std::min(positive, all - positive);
    return std::min(1.0, 2 * lower_tail(signed_null_distribution(count), smaller));
  }
  const double variance = (n * (n + 1) * (2 * n + 1) - ties / 2) / 24;
  const double distance = std::abs(positive - all / 2) - 0.5;
  if (distance <= 0) return 1;
  return std::min(1.0, 2 * cdf(complement(boost::math::normal(), distance / std::sqrt(variance))));
}

Paired judge_pairs(std::span<const double> a, std::span<const double> b) {
  Paired found;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(std::log(b[i] / a[i]));
  if (differences.empty()) return found;
  std::vector<double> averages;  // Walsh's
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) averages.push_back((differences[i] + differences[j]) / 2);
  }
  std::ranges::sort(averages);
  found.ratio = std::exp(median(averages));
  found.p = signed_rank_p(differences);
  if (differences.size() < fewest_pairs) return found;
  const std::size_t excluded = signed_critical(differences.size()).value_or(0);
  found.interval = {std::exp(averages[excluded]),
                    std::exp(averages[averages.size() - 1 - excluded])};
  found.difference = found.p >= level  ? Difference::none
                     : found.ratio > 1 ? Difference::faster
                                       : Difference::slower;
  return found;
}

const char* words(Difference difference) {
  switch (difference) {
    case Difference::slower:
      return "slower";
    case Difference::none:
      return "no difference";
    case Difference::faster:
      return "faster";
    case Difference::too_few:
      return "too few repetitions";
  }
  return "";
}

}  // namespace irt::statistics
