#include "bench/contention/histogram.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "queues/split_mix.hpp"

namespace irt::contention {
namespace {

TEST(Histogram, NoValueIsOffByMoreThanOnePartInItsPrecision) {
  SplitMix random(1);
  for (int i = 0; i < 200'000; ++i) {
    const std::uint64_t value = random.next() >> random.below(64);
    const std::uint64_t end = Histogram::upper_end(Histogram::index_of(value));
    ASSERT_GE(end, value);
    ASSERT_LE(end - value, value / Histogram::precision) << value;
  }
}

TEST(Histogram, BucketsFollowEachOtherWithoutGaps) {
  std::size_t index = 0;
  for (std::uint64_t value = 0; value < 100'000; ++value) {
    const std::size_t now = Histogram::index_of(value);
    ASSERT_TRUE(now == index || now == index + 1) << value;
    if (now != index) {
      ASSERT_EQ(Histogram::upper_end(index), value - 1);
    }
    index = now;
  }
  EXPECT_EQ(Histogram::upper_end(Histogram::index_of(std::numeric_limits<std::uint64_t>::max())),
            std::numeric_limits<std::uint64_t>::max());
}

TEST(Histogram, QuantilesOfKnownValues) {
  Histogram times;
  EXPECT_EQ(times.quantile(0.5), 0U);
  for (std::uint64_t value = 1; value <= 100'000; ++value) times.record(value);
  for (const double share : {0.5, 0.9, 0.99, 0.999, 0.9999}) {
    const double truth = share * 100'000;
    const auto found = static_cast<double>(times.quantile(share));
    EXPECT_GE(found, truth);
    EXPECT_LE(found, truth * (1 + 1.0 / Histogram::precision));
  }
  EXPECT_EQ(times.quantile(0), 1U);
  EXPECT_EQ(times.quantile(1), 100'000U);
  EXPECT_EQ(times.max(), 100'000U);
}

TEST(Histogram, OneOutlierIsTheMaximumAndNotTheTail) {
  Histogram times;
  for (int i = 0; i < 99'999; ++i) times.record(20);
  times.record(5'000'000);
  EXPECT_EQ(times.quantile(0.9999), 20U);
  EXPECT_EQ(times.max(), 5'000'000U);
}

TEST(Histogram, MergingIsRecordingTogether) {
  Histogram a, b, both;
  SplitMix random(7);
  for (int i = 0; i < 10'000; ++i) {
    const std::uint64_t value = random.below(1'000'000);
    (i % 3 == 0 ? a : b).record(value);
    both.record(value);
  }
  Histogram restored;
  restored.add(b.buckets(), b.max());
  a.merge(restored);
  EXPECT_EQ(a.buckets(), both.buckets());
  EXPECT_EQ(a.max(), both.max());
  EXPECT_EQ(a.count(), 10'000U);
}

}  // namespace
}  // namespace irt::contention
