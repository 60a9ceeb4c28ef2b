/// Which of two sets of measurements is larger, whatever their distributions.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "bench/statistics/averages.hpp"

namespace irt::statistics {

/// The test by Mann and Whitney (1947) of whether values of `a` tend to be smaller or larger than
/// those of `b`, two-sided.
struct RankTest {
  double u = 0;  ///< pairs in which the value of `a` is the larger one; a tie is half a pair
  double p = 1;
};
/// Exact where no two values are alike and there are at most `exact_limit` of each; else by the
/// normal approximation with corrections for ties and continuity. p is 1 where one is empty.
RankTest mann_whitney(std::span<const double> a, std::span<const double> b);
inline constexpr std::size_t exact_limit = 50;

/// How many times larger `b` is than `a`, both positive.
struct Ratio {
  double of_medians = 1;
  /// Moses' interval: those factors for which the rank test would not tell `b` from a scaled `a`.
  /// Nothing where there are too few values to exclude any.
  std::optional<Interval> interval;
};
Ratio ratio(std::span<const double> a, std::span<const double> b);

enum class Difference { slower, none, faster, too_few };

/// Of two sets of rates: whether `b` is faster or slower than `a`, at the level of 5 per cent.
/// `too_few` where no outcome whatever could reach that level.
Difference judge(std::span<const double> a, std::span<const double> b);
const char* words(Difference difference);

/// The test by Wilcoxon (1945) of whether `differences` lie around zero, two-sided: their ranks by
/// magnitude are added up with the sign. Exact where no two magnitudes are alike and there are at
/// most `exact_limit`; else by the normal approximation with corrections for ties and continuity.
/// Zeros are left out; p is 1 where nothing else is there.
double signed_rank_p(std::span<const double> differences);

/// What pairs of positive rates say, `b[i]` measured beside `a[i]`: whatever disturbed both alike
/// cancels out, which makes smaller differences visible than `judge` can see.
struct Paired {
  double ratio = 1;  ///< of `b` over `a`: the median of all geometric means of two pairs' ratios
                     ///< (Hodges and Lehmann 1963)
  std::optional<Interval> interval;  ///< Tukey's: the ratios that the test would not reject
  double p = 1;
  Difference difference = Difference::too_few;  ///< fewer than `fewest_pairs` show any
};
Paired judge_pairs(std::span<const double> a, std::span<const double> b);
inline constexpr std::size_t fewest_pairs = 6;  ///< of five, all on one side come once in 16 times

}  // namespace irt::statistics
