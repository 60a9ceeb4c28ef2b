/// The scalar reference by itself: the claims that its header argues from.
#include "renderer/tracing/intersection.hpp"

#include <gtest/gtest.h>

#include "renderer/bvh/single_ray.hpp"
#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {
namespace {

/// A number of any magnitude and sign, zeros of both signs included.
float any_float(Random& random) {
  if (random.below(10) == 0) return random.below(2) == 0 ? 0.0f : -0.0f;
  const float mantissa = random.uniform(1, 2) * (random.below(2) == 0 ? 1.0f : -1.0f);
  const int range = random.below(4) == 0 ? 120 : 4;
  return std::ldexp(mantissa,
                    static_cast<int>(random.below(2 * static_cast<unsigned>(range))) - range);
}
Vec3 any_vec(Random& random) {
  const float x = any_float(random), y = any_float(random), z = any_float(random);
  return {x, y, z};
}

/// Rule 1 of the header, on a million nested pairs of boxes.
TEST(Slab, GrowingABoxNeverShrinksTheInterval) {
  Random random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    Box inner;
    inner.grow(any_vec(random));
    inner.grow(any_vec(random));
    Box outer = inner;
    outer.grow(any_vec(random));
    const TraversalRay ray({random.below(2) == 0 ? any_vec(random) : inner.lo, any_vec(random)});
    const Interval in = slab(inner, ray), out = slab(outer, ray);
    ASSERT_LE(out.entry, in.entry);
    ASSERT_GE(out.exit, in.exit);
  }
}

TEST(Slab, AxisParallelRayOnAFaceIsInside) {
  for (const float zero : {0.0f, -0.0f}) {
    const Triangle wall{{0, 0, 0}, {0, 4, 0}, {0, 0, 4}};
    const Interval inside = slab(padded_bounds(wall), TraversalRay({{0, 1, -1}, {zero, zero, 1}}));
    EXPECT_TRUE(inside.reaches(10));
    EXPECT_NEAR(inside.entry, 1, 1e-5);
    EXPECT_NEAR(inside.exit, 5, 1e-5);
    const Interval beside =
        slab(padded_bounds(wall), TraversalRay({{0.001f, 1, -1}, {zero, zero, 1}}));
    EXPECT_FALSE(beside.reaches(10));
  }
}

TEST(Meet, EqualDistancesGoToTheLowestIndexInAnyOrder) {
  const Triangle triangle{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  const KernelRay<scalar::MollerTrumbore> ray({{0.25f, 0.25f, 0}, {0, 0, 1}});
  for (const auto& order :
       {std::array{3u, 1u, 2u}, std::array{1u, 2u, 3u}, std::array{2u, 3u, 1u}}) {
    Hit best = no_hit(ray);
    for (const std::uint32_t index : order) ray.meet(triangle, index, best);
    EXPECT_EQ(best.triangle, 1u);
  }
}

TEST(Meet, TheEndOfARayIsNotMet) {
  const Triangle triangle{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  for (const float end : {4.0f, 5.0f, 5.00001f, 6.0f}) {
    const KernelRay<scalar::MollerTrumbore> ray({{0.25f, 0.25f, 0}, {0, 0, 1}, end});
    Hit best = no_hit(ray);
    ray.meet(triangle, 0, best);
    EXPECT_EQ(best.triangle == 0, end > 5) << end;
  }
}

}  // namespace
}  // namespace irt::test
