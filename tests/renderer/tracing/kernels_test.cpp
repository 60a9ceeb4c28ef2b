/// The kernels one by one, as scalar code: what all four must do.
#include <gtest/gtest.h>

#include "renderer/bvh/single_ray.hpp"
#include "renderer/tracing/kernels-inl.hpp"
#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {
namespace {

template <class Kernel>
class Kernels : public ::testing::Test {
 public:
  static bool crosses(const Triangle& triangle, const Ray& ray, Hit& hit) {
    return KernelRay<Kernel>(ray).crosses(triangle, hit);
  }
};
using AllKernels = ::testing::Types<scalar::MollerTrumbore, scalar::KenslerShirley,
                                    scalar::Projection, scalar::Watertight>;
class KernelNames {
 public:
  template <class Kernel>
  static std::string GetName(int i) {  // NOLINT(readability-identifier-naming): GoogleTest's
    constexpr const char* names[]{"moller_trumbore", "kensler_shirley", "projection", "watertight"};
    return names[i];
  }
};
TYPED_TEST_SUITE(Kernels, AllKernels, KernelNames);

TYPED_TEST(Kernels, FindsPlaceAndWeights) {
  // The same triangle facing every axis, either way round, met from either side.
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [axis](float u, float v, float w) {
      Vec3 a;
      a[(axis + 1) % 3] = u;
      a[(axis + 2) % 3] = v;
      a[axis] = w;
      return a;
    };
    for (const float side : {1.0f, -1.0f}) {
      const Ray ray{turned(0.25f, 0.5f, 5 - 5 * side), turned(0, 0, 2 * side)};
      const Triangle triangle{turned(0, 0, 5), turned(1, 0, 5), turned(0, 1, 5)};
      Hit hit;
      ASSERT_TRUE(this->crosses(triangle, ray, hit));
      EXPECT_FLOAT_EQ(hit.t, 2.5f);
      EXPECT_FLOAT_EQ(hit.u, 0.25f);
      EXPECT_FLOAT_EQ(hit.v, 0.5f);
      ASSERT_TRUE(this->crosses({triangle.a, triangle.c, triangle.b}, ray, hit));
      EXPECT_FLOAT_EQ(hit.u, 0.5f);
      EXPECT_FLOAT_EQ(hit.v, 0.25f);
      EXPECT_FALSE(this->crosses(triangle, {turned(0.75f, 0.5f, 0), turned(0, 0, 1)}, hit));
      EXPECT_FALSE(this->crosses(triangle, {turned(-0.1f, 0.5f, 0), turned(0, 0, 1)}, hit));
    }
  }
}

/// A threshold on the determinant of 1e-6 would lose every one of these.
TYPED_TEST(Kernels, MeetsTrianglesOfAMicrometre) {
  const Triangle triangle{{0, 0, 0.1f}, {1e-6f, 0, 0.1f}, {0, 1e-6f, 0.1f}};
  Hit hit;
  ASSERT_TRUE(this->crosses(triangle, {{2e-7f, 3e-7f, 0}, {0, 0, 1}}, hit));
  EXPECT_NEAR(hit.t, 0.1f, 1e-6);
}

TYPED_TEST(Kernels, PointsNeedlesAndNansAreNotMet) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float inf = std::numeric_limits<float>::infinity();
  const Vec3 a{0.25f, 0.25f, 1}, b{0.5f, 0.25f, 1};
  const Triangle bad[]{{a, a, a},
                       {a, b, a},
                       {a, a, b},
                       {b, a, a},
                       {{0, 0.25f, 1}, {1, 0.25f, 1}, {0.5f, 0.25f, 1}},
                       {{nan, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                       {{inf, 0, 1}, {-inf, 0, 1}, {0, inf, 1}}};
  Hit hit;
  for (const Triangle& triangle : bad) {
    EXPECT_FALSE(this->crosses(triangle, {{0.25f, 0.25f, 0}, {0, 0, 1}}, hit));
    EXPECT_FALSE(this->crosses(triangle, {{0.25f, 0.25f, 0}, {0, 0, -1}}, hit));
  }
}

TYPED_TEST(Kernels, ALineInThePlaneIsNotMet) {
  const Triangle triangle{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  Hit hit;
  EXPECT_FALSE(this->crosses(triangle, {{-1, 0.25f, 1}, {1, 0, 0}}, hit));
}

/// Against the exact answer in double precision, on random triangles that are no needles.
TYPED_TEST(Kernels, AgreesWithDoublePrecision) {
  Random random(6);
  int met = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 lo{-1, -1, -1}, hi{1, 1, 1};
    const Triangle triangle{random.in_box(lo, hi), random.in_box(lo, hi), random.in_box(lo, hi)};
    const Ray ray{random.in_box(lo * 3.0f, hi * 3.0f), random.in_box(lo, hi)};
    const auto d = [](Vec3 a) { return scalar::VecOf<double>{a.x, a.y, a.z}; };
    const auto minus = [](auto a, auto b) {
      return scalar::VecOf<double>{a.x - b.x, a.y - b.y, a.z - b.z};
    };
    const auto e1 = minus(d(triangle.b), d(triangle.a)), e2 = minus(d(triangle.c), d(triangle.a));
    const auto s = minus(d(ray.origin), d(triangle.a));
    const auto p = scalar::cross(d(ray.direction), e2), q = scalar::cross(s, e1);
    const double determinant = scalar::dot(e1, p);
    if (std::fabs(determinant) < 1e-2) continue;
    const double u = scalar::dot(s, p) / determinant,
                 v = scalar::dot(d(ray.direction), q) / determinant;
    const double t = scalar::dot(e2, q) / determinant;
    const double inside = std::min({u, v, 1 - u - v});
    if (std::fabs(inside) < 1e-4) continue;
    Hit hit;
    ASSERT_EQ(this->crosses(triangle, ray, hit), inside > 0);
    if (inside < 0) continue;
    ++met;
    ASSERT_NEAR(hit.t, t, 1e-3 * (1 + std::fabs(t)));
    ASSERT_NEAR(hit.u, u, 1e-3);
    ASSERT_NEAR(hit.v, v, 1e-3);
  }
  EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace irt::test
