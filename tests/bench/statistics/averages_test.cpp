// Known values are counted by hand or taken from tables of the distributions.
#include "bench/statistics/averages.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace irt::statistics {
namespace {

using Values = std::vector<double>;

TEST(Median, LiesInTheMiddleOrBetweenTheTwoThere) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
}

TEST(Quantile, Interpolates) {
  EXPECT_DOUBLE_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 2, 3}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({1, 2, 3, 4, 5}, 0.25), 2);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.75), 7);
}

TEST(StudentInterval, KnownValues) {
  EXPECT_FALSE(student_interval(Values{}));
  EXPECT_FALSE(student_interval(Values{3}));
  // Mean 3, standard deviation sqrt(2.5), t(4, 0.975) = 2.776445.
  const auto five = student_interval(Values{1, 2, 3, 4, 5});
  EXPECT_NEAR(five->low, 3 - 2.776445 * std::sqrt(2.5 / 5), 1e-6);
  EXPECT_NEAR(five->high, 3 + 2.776445 * std::sqrt(2.5 / 5), 1e-6);
  // t(1, 0.975) = 12.706205.
  EXPECT_NEAR(student_interval(Values{0, 2})->high, 1 + 12.706205, 1e-6);
}

TEST(StudentInterval, HoldsTheMeanInNineteenOfTwentyCases) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> rate(100, 5);
  int holds = 0;
  for (int i = 0; i < 4000; ++i) {
    Values values(5);
    for (double& value : values) value = rate(random);
    const Interval interval = *student_interval(values);
    holds += interval.low <= 100 && 100 <= interval.high ? 1 : 0;
  }
  EXPECT_NEAR(holds / 4000.0, 0.95, 0.015);  // four standard errors
}

TEST(HalfInterval, IsTheSameFromTheStandardDeviation) {
  EXPECT_FALSE(half_interval(Values{3}));
  EXPECT_DOUBLE_EQ(half_interval(std::sqrt(2.5), 5), *half_interval(Values{1, 2, 3, 4, 5}));
}

TEST(MedianInterval, HoldsTheMedianInNineteenOfTwentyCases) {
  std::mt19937_64 random(1);
  std::exponential_distribution<double> time(1);
  int holds = 0;
  for (int i = 0; i < 4000; ++i) {
    Values values(41);
    for (double& value : values) value = time(random);
    const Interval interval = median_interval(values);
    holds += interval.low <= std::log(2) && std::log(2) <= interval.high ? 1 : 0;
  }
  EXPECT_NEAR(holds / 4000.0, 0.95, 0.015);
}

}  // namespace
}  // namespace irt::statistics
