/// Every kernel gives the scalar bits in lanes of every width on every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/renderer/tracing/lanes_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/tracing/kernels-inl.hpp"

#ifndef IRT_TESTS_LANES
#define IRT_TESTS_LANES
namespace irt::test {

/// 16 lines against 16 triangles, and where each meets its own.
struct LanesCase {
  alignas(64) float corner[9][16];
  alignas(64) float line[6][16];
  alignas(64) float end[16];
  std::uint32_t met;
  alignas(64) float t[16], u[16], v[16];
};
using LanesRun = void (*)(LanesCase&, int kernel);

}  // namespace irt::test
#endif

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

template <class Kernel, class F>
void cross_lanes(test::LanesCase& lanes, int first) {
  const auto load = [first](const float* from) HWY_ATTR {
    if constexpr (std::is_same_v<F, float>) {
      return from[first];
    } else {
      return F::load(from + first);
    }
  };
  const auto vec = [&load](const float(*from)[16]) HWY_ATTR {
    return VecOf<F>{load(from[0]), load(from[1]), load(from[2])};
  };
  const CornersOf<F> corners{vec(lanes.corner), vec(lanes.corner + 3), vec(lanes.corner + 6)};
  const LineOf<F> line{vec(lanes.line), vec(lanes.line + 3), load(lanes.end)};
  const CrossingOf<F> crossing =
      cross_at<Kernel, F>(Kernel::template prepare<F>(corners), Kernel::template prepare<F>(line));
  if constexpr (std::is_same_v<F, float>) {
    lanes.met |= static_cast<std::uint32_t>(crossing.met) << first;
    lanes.t[first] = crossing.t;
    lanes.u[first] = crossing.u;
    lanes.v[first] = crossing.v;
  } else {
    lanes.met |= crossing.met.bits() << first;
    crossing.t.store(lanes.t + first);
    crossing.u.store(lanes.u + first);
    crossing.v.store(lanes.v + first);
  }
}

template <class F, int width>
void cross_all(test::LanesCase& lanes, int kernel) {
  lanes.met = 0;
  for (int i = 0; i < 16; i += width) {
    if (kernel == 0) cross_lanes<MollerTrumbore, F>(lanes, i);
    if (kernel == 1) cross_lanes<KenslerShirley, F>(lanes, i);
    if (kernel == 2) cross_lanes<Projection, F>(lanes, i);
    if (kernel == 3) cross_lanes<Watertight, F>(lanes, i);
  }
}

void cross_single(test::LanesCase& lanes, int kernel) {
  cross_all<float, 1>(lanes, kernel);
}
#if HWY_TARGET != HWY_SCALAR
void cross_by_4(test::LanesCase& lanes, int kernel) {
  cross_all<Floats<4>, 4>(lanes, kernel);
}
void cross_by_8(test::LanesCase& lanes, int kernel) {
  cross_all<Floats<8>, 8>(lanes, kernel);
}
void cross_by_16(test::LanesCase& lanes, int kernel) {
  cross_all<Floats<16>, 16>(lanes, kernel);
}
#else  // One lane: nothing to compare.
void cross_by_4(test::LanesCase& lanes, int kernel) {
  cross_single(lanes, kernel);
}
void cross_by_8(test::LanesCase& lanes, int kernel) {
  cross_single(lanes, kernel);
}
void cross_by_16(test::LanesCase& lanes, int kernel) {
  cross_single(lanes, kernel);
}
#endif

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <bit>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/renderer/bvh/meshes.hpp"

namespace irt {

HWY_EXPORT(cross_single);
HWY_EXPORT(cross_by_4);
HWY_EXPORT(cross_by_8);
HWY_EXPORT(cross_by_16);

namespace test {
namespace {

/// A quarter of the lines aim at a corner, a quarter at an edge's middle, the rest at random;
/// some triangles are points or
/// needles, and a third of the lines have an end.
LanesCase random_case(Random& random) {
  LanesCase lanes{};
  for (int i = 0; i < 16; ++i) {
    Vec3 corner[3];
    for (Vec3& c : corner) c = random.in_box({-1, -1, -1}, {1, 1, 1});
    if (random.below(10) == 0) corner[2] = corner[random.below(2)];
    const Vec3 origin = random.in_box({-3, -3, -3}, {3, 3, 3});
    Vec3 target = random.in_box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    if (i % 4 == 0) target = corner[0];
    if (i % 4 == 1) target = (corner[0] + corner[1]) * 0.5f;
    const Vec3 direction = target - origin;
    // Targets are at 1: some lines end before, at or behind what they aim at.
    lanes.end[i] = i % 3 == 0 ? random.in_box({}, {2, 2, 2}).x : std::numeric_limits<float>::max();
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) lanes.corner[3 * k + axis][i] = corner[k][axis];
      lanes.line[axis][i] = origin[axis];
      lanes.line[3 + axis][i] = direction[axis];
    }
  }
  return lanes;
}

void expect_same_bits(const LanesCase& single, const LanesCase& lanes) {
  ASSERT_EQ(single.met, lanes.met);
  for (int i = 0; i < 16; ++i) {
    if ((single.met >> i & 1) == 0) continue;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(single.t[i]), std::bit_cast<std::uint32_t>(lanes.t[i]));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(single.u[i]), std::bit_cast<std::uint32_t>(lanes.u[i]));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(single.v[i]), std::bit_cast<std::uint32_t>(lanes.v[i]));
  }
}

TEST(Lanes, GiveTheBitsOfOneFloat) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    const LanesRun by_width[]{HWY_DYNAMIC_DISPATCH(cross_by_4), HWY_DYNAMIC_DISPATCH(cross_by_8),
                              HWY_DYNAMIC_DISPATCH(cross_by_16)};
    Random random(9);
    std::uint32_t met = 0;
    for (int i = 0; i < 5000; ++i) {
      LanesCase single = random_case(random);
      for (int kernel = 0; kernel < 4; ++kernel) {
        HWY_STATIC_DISPATCH(cross_single)(single, kernel);
        met += static_cast<std::uint32_t>(std::popcount(single.met));
        for (const LanesRun run : by_width) {
          LanesCase lanes = single;
          run(lanes, kernel);
          expect_same_bits(single, lanes);
          if (HasFatalFailure()) return;
        }
      }
    }
    EXPECT_GT(met, 50'000u);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace test
}  // namespace irt
#endif  // HWY_ONCE
