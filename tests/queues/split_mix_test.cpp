#include "queues/split_mix.hpp"

#include <gtest/gtest.h>

namespace irt {
namespace {

// Of Vigna's implementation (https://prng.di.unimi.it/splitmix64.c).
TEST(SplitMix, DrawsWhatOthersDraw) {
  SplitMix random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random.next(), 9817491932198370423u);
  EXPECT_EQ(SplitMix(0).next(), 0xe220'a839'7b1d'cdafu);
}

TEST(SplitMix, FindsANumberByItsPlace) {
  SplitMix random(0);
  for (std::uint64_t number = 1; number < 10; ++number) {
    EXPECT_EQ(SplitMix::at(number), random.next());
  }
}

TEST(SplitMix, StaysBelowItsLimit) {
  SplitMix random(1), same(1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(random.below(7), same.next() % 7);
    const float number = random.uniform();
    EXPECT_EQ(number, static_cast<float>(same.next() >> 40) * 0x1p-24f);
    EXPECT_LT(number, 1);
  }
}

}  // namespace
}  // namespace irt
