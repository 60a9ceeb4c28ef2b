#include "renderer/shading/random.hpp"

#include <gtest/gtest.h>
#include <set>

namespace irt {
namespace {

TEST(RayRandom, UniformNumbersFillTheUnitInterval) {
  double sum = 0, squares = 0;
  constexpr int count = 100'000;
  for (int i = 0; i < count; ++i) {
    RayRandom random(static_cast<std::uint32_t>(i) % 300, static_cast<std::uint32_t>(i) / 300, 2);
    const float number = random.uniform();
    ASSERT_GE(number, 0);
    ASSERT_LT(number, 1);
    sum += number;
    squares += double{number} * number;
  }
  // A uniform number has the mean 1/2 and the mean square 1/3; five standard deviations.
  EXPECT_NEAR(sum / count, 0.5, 5 * 0.2887 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 1.0 / 3, 5 * 0.2981 / std::sqrt(count));
}

TEST(RayRandom, EveryRayHasItsOwnStream) {
  std::set<float> first;
  for (std::uint32_t pixel = 0; pixel < 10; ++pixel) {
    for (std::uint32_t sample = 0; sample < 10; ++sample) {
      for (std::uint32_t bounce = 0; bounce < 10; ++bounce) {
        first.insert(RayRandom(pixel, sample, bounce).uniform());
      }
    }
  }
  EXPECT_EQ(first.size(), 1000u);
  EXPECT_EQ(RayRandom(1, 2, 3).uniform(), RayRandom(1, 2, 3).uniform());
}

TEST(RayRandom, DirectionsAreSpreadByTheCosine) {
  const Vec3 normal = normalize({1, -2, 3});
  RayRandom random(7, 0, 0);
  double cosines = 0, squares = 0;
  Vec3 mean{};
  constexpr int count = 100'000;
  for (int i = 0; i < count; ++i) {
    const Vec3 direction = random.cosine_weighted(normal);
    const float cosine = dot(direction, normal);
    ASSERT_GT(cosine, 0);
    ASSERT_NEAR(length(direction), 1, 1e-5);
    cosines += cosine;
    squares += double{cosine} * cosine;
    mean = mean + direction * (1.0f / count);
  }
  // With the density cos/pi the mean cosine is 2/3 and the mean of its square 1/2.
  EXPECT_NEAR(cosines / count, 2.0 / 3, 0.005);
  EXPECT_NEAR(squares / count, 0.5, 0.005);
  EXPECT_NEAR(length(cross(mean, normal)), 0, 0.01);  // no side is preferred
}

}  // namespace
}  // namespace irt
