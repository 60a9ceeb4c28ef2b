/// The scalar reference by itself: the claims that its header argues from.
#include "renderer/tracing/intersection.hpp"

#include <gtest/gtest.h>

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

TEST(MollerTrumbore, FindsPlaceAndWeights) {
  const Triangle triangle{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  Hit hit;
  ASSERT_TRUE(moller_trumbore(triangle, TraversalRay({{0.25f, 0.5f, 0}, {0, 0, 2}}), hit));
  EXPECT_FLOAT_EQ(hit.t, 2.5f);
  EXPECT_FLOAT_EQ(hit.u, 0.25f);
  EXPECT_FLOAT_EQ(hit.v, 0.5f);
  EXPECT_FALSE(moller_trumbore(triangle, TraversalRay({{0.75f, 0.5f, 0}, {0, 0, 1}}), hit));
  EXPECT_FALSE(moller_trumbore(triangle, TraversalRay({{-0.1f, 0.5f, 0}, {0, 0, 1}}), hit));
}

TEST(MollerTrumbore, BothSidesAreMet) {
  const Triangle front{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}}, back{front.a, front.c, front.b};
  const TraversalRay ray({{0.25f, 0.5f, 0}, {0, 0, 1}});
  Hit hit;
  EXPECT_TRUE(moller_trumbore(front, ray, hit));
  EXPECT_TRUE(moller_trumbore(back, ray, hit));
}

/// A threshold on the determinant of 1e-6 would lose every one of these.
TEST(MollerTrumbore, MeetsTrianglesOfAMicrometre) {
  const Triangle triangle{{0, 0, 0.1f}, {1e-6f, 0, 0.1f}, {0, 1e-6f, 0.1f}};
  Hit hit;
  ASSERT_TRUE(moller_trumbore(triangle, TraversalRay({{2e-7f, 3e-7f, 0}, {0, 0, 1}}), hit));
  EXPECT_NEAR(hit.t, 0.1f, 1e-6);
}

TEST(Meet, EqualDistancesGoToTheLowestIndexInAnyOrder) {
  const Triangle triangle{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  const TraversalRay ray({{0.25f, 0.25f, 0}, {0, 0, 1}});
  for (const auto& order :
       {std::array{3u, 1u, 2u}, std::array{1u, 2u, 3u}, std::array{2u, 3u, 1u}}) {
    Hit best = no_hit(ray);
    for (const std::uint32_t index : order) meet(triangle, index, ray, best);
    EXPECT_EQ(best.triangle, 1u);
  }
}

TEST(Meet, TheEndOfARayIsNotMet) {
  const Triangle triangle{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  for (const float end : {4.0f, 5.0f, 5.00001f, 6.0f}) {
    const TraversalRay ray({{0.25f, 0.25f, 0}, {0, 0, 1}, end});
    Hit best = no_hit(ray);
    meet(triangle, 0, ray, best);
    EXPECT_EQ(best.triangle == 0, end > 5) << end;
  }
}

}  // namespace
}  // namespace irt::test
