// Known values are counted by hand or taken from tables of the distributions.
#include "bench/statistics/rank_tests.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace irt::statistics {
namespace {

using Values = std::vector<double>;

TEST(MannWhitney, SmallSetsByCountingByHand) {
  // Of the 20 ways to choose three of six, one has all of `a` below `b`; two-sided, one more.
  EXPECT_DOUBLE_EQ(mann_whitney(Values{1, 2, 3}, Values{4, 5, 6}).p, 0.1);
  EXPECT_DOUBLE_EQ(mann_whitney(Values{1, 2, 3}, Values{4, 5, 6}).u, 0);
  EXPECT_DOUBLE_EQ(mann_whitney(Values{4, 5, 6}, Values{1, 2, 3}).u, 9);
  // Of 70 ways, U is 0 in one and 1 in one.
  EXPECT_DOUBLE_EQ(mann_whitney(Values{1, 2, 3, 5}, Values{4, 6, 7, 8}).p, 4.0 / 70);
  EXPECT_DOUBLE_EQ(mann_whitney(Values{1, 4}, Values{2, 3}).p, 1);
  EXPECT_DOUBLE_EQ(mann_whitney(Values{}, Values{2, 3}).p, 1);
}

TEST(MannWhitney, TiesByTheNormalApproximation) {
  // n = m = 5, U = 2.5; ties of 2, 2 and 2: variance 25/12 (11 - 18/90) = 22.5.
  const RankTest test = mann_whitney(Values{1, 2, 2, 3, 4}, Values{4, 5, 5, 6, 7});
  EXPECT_DOUBLE_EQ(test.u, 0.5);
  EXPECT_NEAR(test.p, std::erfc((12 - 0.5) / std::sqrt(22.5) / std::sqrt(2.0)), 1e-12);
  EXPECT_DOUBLE_EQ(mann_whitney(Values{3, 3, 3, 3}, Values{3, 3, 3, 3}).p, 1);
}

TEST(MannWhitney, ApproximationAgreesWithCounting) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> rate(100, 5);
  Values a(exact_limit), b(exact_limit);
  for (double& value : a) value = rate(random);
  for (double& value : b) value = rate(random) + 2;
  const double exact = mann_whitney(a, b).p;
  a.push_back(a.back() + 1e-9);
  EXPECT_NEAR(mann_whitney(a, b).p, exact, 0.1 * exact + 1e-3);
}

TEST(Difference, EqualsAreCalledEqualNineteenTimesInTwenty) {
  // Skewed, as rates on a disturbed machine are.
  std::mt19937_64 random(3);
  std::gamma_distribution<double> disturbance(2, 0.05);
  int different = 0;
  constexpr int comparisons = 2000;
  for (int i = 0; i < comparisons; ++i) {
    Values a(10), b(10);
    for (double& value : a) value = 1e6 / (1 + disturbance(random));
    for (double& value : b) value = 1e6 / (1 + disturbance(random));
    different += judge(a, b) == Difference::none ? 0 : 1;
  }
  EXPECT_LE(different, comparisons * (0.05 + 0.015));
  EXPECT_GE(different, comparisons * 0.03);  // a test that never speaks would pass the other line
}

TEST(Difference, FivePerCentAreFoundAtThirtyRepetitions) {
  // With a coefficient of variation of 5 per cent.
  std::mt19937_64 random(4);
  std::normal_distribution<double> rate(100, 5);
  int found = 0, backwards = 0;
  constexpr int comparisons = 300;
  for (int i = 0; i < comparisons; ++i) {
    Values a(30), b(30);
    for (double& value : a) value = rate(random);
    for (double& value : b) value = rate(random) * 0.95;
    const Difference difference = judge(a, b);
    found += difference == Difference::slower ? 1 : 0;
    backwards += difference == Difference::faster ? 1 : 0;
  }
  EXPECT_GE(found, comparisons * 0.93);
  EXPECT_EQ(backwards, 0);
}

TEST(Difference, TooFewRepetitionsAreNotCalledEqual) {
  EXPECT_EQ(judge(Values{1, 2, 3}, Values{4, 5, 6}), Difference::too_few);
  EXPECT_EQ(judge(Values{1, 2, 3, 4}, Values{5, 6, 7, 8}), Difference::faster);
  EXPECT_EQ(judge(Values{5, 6, 7, 8}, Values{1, 2, 3, 4}), Difference::slower);
  EXPECT_EQ(judge(Values{}, Values{1}), Difference::too_few);
}

TEST(Ratio, OfMediansAndItsInterval) {
  const Ratio twice = ratio(Values{1, 2, 3, 4, 5}, Values{2, 4, 6, 8, 10});
  EXPECT_DOUBLE_EQ(twice.of_medians, 2);
  // n = m = 5: P(U <= 2) = 4/252, so the third smallest and largest of 25 ratios.
  EXPECT_DOUBLE_EQ(twice.interval->low, 2.0 / 3);
  EXPECT_DOUBLE_EQ(twice.interval->high, 6);
  EXPECT_FALSE(ratio(Values{1, 2, 3}, Values{4, 5, 6}).interval);
}

TEST(Ratio, TheIntervalHoldsTheTruthAndAgreesWithTheVerdict) {
  std::mt19937_64 random(5);
  std::lognormal_distribution<double> rate(0, 0.1);
  int holds = 0, agree = 0;
  constexpr int comparisons = 1000;
  for (int i = 0; i < comparisons; ++i) {
    Values a(8), b(8);
    for (double& value : a) value = rate(random);
    for (double& value : b) value = rate(random) * 1.1;
    const Interval interval = *ratio(a, b).interval;
    holds += interval.low <= 1.1 && 1.1 <= interval.high ? 1 : 0;
    const bool excludes_one = interval.low > 1 || interval.high < 1;
    agree += excludes_one == (judge(a, b) != Difference::none) ? 1 : 0;
  }
  EXPECT_GE(holds, comparisons * 0.93);
  EXPECT_EQ(agree, comparisons);
}

TEST(SignedRank, SmallSetsByCountingByHand) {
  // Of 64 ways to sign six ranks, one has all of them negative; two-sided, one more.
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{1, 2, 3, 4, 5, 6}), 2.0 / 64);
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{-1, -2, -3, -4, -5, -6}), 2.0 / 64);
  // Negative ranks add up to 3: {}, {1}, {2}, {3}, {1, 2} are as far out.
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{-1, -2, 3, 4, 5, 6}), 10.0 / 64);
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{1, 2, 3, 4, 5, 6, 0}), 2.0 / 64);
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{0, 0}), 1);
  EXPECT_DOUBLE_EQ(signed_rank_p(Values{}), 1);
}

TEST(SignedRank, TiesByTheNormalApproximation) {
  // Ranks 1.5, 1.5, 3, 4; W = 8.5 of 10; variance (4 5 9 - 6/2) / 24.
  const double z = (8.5 - 5 - 0.5) / std::sqrt((180 - 3.0) / 24);
  EXPECT_NEAR(signed_rank_p(Values{-1, 1, 2, 3}), std::erfc(z / std::sqrt(2.0)), 1e-12);
}

TEST(Pairs, RatioAndItsInterval) {
  const Paired twice = judge_pairs(Values{1, 2, 3, 4, 5, 6}, Values{2, 4.4, 6.06, 8.4, 9.5, 11.76});
  // Six pairs: P(W <= 0) = 1/64, so the interval goes from the least ratio to the largest.
  EXPECT_DOUBLE_EQ(twice.interval->low, 1.9);
  EXPECT_DOUBLE_EQ(twice.interval->high, 2.2);
  EXPECT_NEAR(twice.ratio, 2.01, 0.03);
  EXPECT_EQ(twice.difference, Difference::faster);
  EXPECT_EQ(judge_pairs(Values{1, 2, 3, 4, 5}, Values{2, 4, 6, 8, 10}).difference,
            Difference::too_few);
  EXPECT_EQ(judge_pairs(Values{}, Values{}).difference, Difference::too_few);
}

/// Rounds on a machine whose pace drifts, by far more than queues differ.
struct Drifting {
  explicit Drifting(std::uint64_t seed) : random(seed) {}

  void rounds(std::size_t count, double factor, Values& a, Values& b) {
    std::normal_distribution<double> drift(0, 0.2), own(0, 0.04);
    a.clear();
    b.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const double pace = std::exp(drift(random));
      a.push_back(pace * std::exp(own(random)));
      b.push_back(pace * std::exp(own(random)) * factor);
    }
  }
  /// How often `says(a, b)` holds of so many sets of `count` rounds.
  template <class Says>
  int times(int sets, std::size_t count, double factor, Says says) {
    int held = 0;
    Values a, b;
    for (int i = 0; i < sets; ++i) {
      rounds(count, factor, a, b);
      held += says(a, b) ? 1 : 0;
    }
    return held;
  }
  std::mt19937_64 random;
};

TEST(Pairs, EqualsAreCalledEqualNineteenTimesInTwenty) {
  constexpr int comparisons = 2000;
  const int different = Drifting(6).times(comparisons, 10, 1, [](const Values& a, const Values& b) {
    return judge_pairs(a, b).difference != Difference::none;
  });
  EXPECT_LE(different, comparisons * (0.05 + 0.015));
  EXPECT_GE(different, comparisons * 0.03);
}

TEST(Pairs, FivePerCentAreFoundWhereTheMachineDriftsByTwenty) {
  constexpr int comparisons = 300;
  const auto found = [](auto judge) {
    return Drifting(7).times(comparisons, 30, 0.95, [judge](const Values& a, const Values& b) {
      return judge(a, b) == Difference::slower;
    });
  };
  EXPECT_GE(found([](const Values& a, const Values& b) { return judge_pairs(a, b).difference; }),
            comparisons * 0.95);
  EXPECT_LE(found([](const Values& a, const Values& b) { return judge(a, b); }), comparisons * 0.4);
}

TEST(Pairs, TheIntervalHoldsTheTruthAndAgreesWithTheVerdict) {
  constexpr int comparisons = 1000;
  const int holds = Drifting(8).times(comparisons, 12, 1.03, [](const Values& a, const Values& b) {
    const Paired found = judge_pairs(a, b);
    const bool excludes_one = found.interval->low > 1 || found.interval->high < 1;
    EXPECT_EQ(excludes_one, found.difference != Difference::none);
    return found.interval->low <= 1.03 && 1.03 <= found.interval->high;
  });
  EXPECT_GE(holds, comparisons * 0.93);
}

}  // namespace
}  // namespace irt::statistics
