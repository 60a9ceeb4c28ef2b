#include "renderer/engine/time_histogram.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace irt {
namespace {

TEST(TimeHistogram, QuantilesAreExactToAnEighth) {
  for (std::uint64_t ns = 0; ns < 1'000'000'000'000u; ns = ns * 9 / 8 + 1) {
    TimeHistogram one;
    one.add(ns);
    EXPECT_NEAR(one.quantile(0.5), static_cast<double>(ns), static_cast<double>(ns) / 8);
  }
}

TEST(TimeHistogram, CountsAllAndFindsTheTail) {
  TimeHistogram times, more;
  EXPECT_EQ(times.quantile(0.5), 0);
  for (int i = 0; i < 98; ++i) times.add(2);
  more.add(1'000'000);
  more.add(std::numeric_limits<std::uint64_t>::max());
  times += more;
  EXPECT_EQ(times.quantile(0), 2);
  EXPECT_EQ(times.quantile(0.98), 2);
  EXPECT_NEAR(times.quantile(0.99), 1e6, 1e6 / 8);
  EXPECT_GT(times.quantile(1), 1e12);
}

}  // namespace
}  // namespace irt
