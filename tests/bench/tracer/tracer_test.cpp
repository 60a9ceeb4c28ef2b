/// The tracer bench measures what it says: the same rays, answered alike by everybody.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "bench/tracer/frame.hpp"
#include "bench/tracer/measurement.hpp"
#include "bench/tracer/scene_rays.hpp"
#include "renderer/scene/scenes.hpp"

namespace irt::tracer {
namespace {

const std::vector<std::string> everything{"all"};

Contestants all_contestants(const Mesh& mesh) {
  Contestants contestants = our_contestants(mesh, everything);
  for (auto& one : embree_contestants(mesh, everything)) contestants.push_back(std::move(one));
  return contestants;
}

TEST(TracerBench, NamesAreKnown) {
  const Scene scene = load_scene("office");
  const Contestants contestants = all_contestants(scene.mesh);
  const bool has_embree = !contestants.back().ours;
  for (const std::string_view name : usual_contestants()) {
    if (!has_embree && name.starts_with("embree")) continue;
    EXPECT_TRUE(std::ranges::any_of(contestants, [&](const auto& one) { return one.name == name; }))
        << name;
  }
}

TEST(TracerBench, EverybodyAnswersAlike) {
  const Scene scene = load_scene("office");
  const Contestants contestants = all_contestants(scene.mesh);
  ThreadExecutor executor(2);
  for (const RayKind kind : {RayKind::primary, RayKind::shadow, RayKind::specular}) {
    const std::vector<Rays> batches = rays_of(scene, 90, kind, contestants.front());
    std::vector<Answers> reference, answers;
    for (std::size_t i = 0; i < batches.size(); ++i) {
      reference.emplace_back(tile_rays);
      answers.emplace_back(tile_rays);
    }
    trace_all(contestants.front(), kind, batches, reference, executor);
    for (const Contestant& contestant : contestants) {
      trace_all(contestant, kind, batches, answers, executor);
      const Disagreement found = compare(kind, batches, reference, answers);
      EXPECT_GE(found.rays, kind == RayKind::shadow ? 4u * 8000 : 8000u);
      if (contestant.same_bits) {
        EXPECT_EQ(found.bits, 0u) << contestant.name;
      } else {
        EXPECT_LE(found.missed + found.elsewhere, 5u) << contestant.name;
      }
    }
  }
}

TEST(TracerBench, FramesAreAlike) {
  const Scene scene = load_scene("office");
  const std::vector<std::string> some{"wide 1", "wide 16", "wald 8", "embree 1", "embree 16"};
  Contestants contestants = our_contestants(scene.mesh, some);
  EXPECT_EQ(contestants.size(), 3u);
  for (auto& one : embree_contestants(scene.mesh, some)) contestants.push_back(std::move(one));
  FrameBench first(scene, 50, 2, contestants.front());
  EXPECT_GT(first.run(), 0);
  EXPECT_GT(first.rays(), 50u * 50 * 2);
  EXPECT_GT(first.frame().sum(50 * 25 + 25).x, 0.05f);
  for (const Contestant& contestant : contestants) {
    FrameBench bench(scene, 50, 2, contestant);
    bench.run();
    if (contestant.same_bits) {
      EXPECT_EQ(bench.frame().hash(), first.frame().hash()) << contestant.name;
    }
    EXPECT_LE(differing_pixels(bench.frame(), first.frame()), contestant.same_bits ? 0u : 5u)
        << contestant.name;
  }
  FixedPointFrameBuffer black(50, 50);
  EXPECT_GT(differing_pixels(black, first.frame()), 2000u);
}

TEST(TracerBench, DisagreementIsCounted) {
  std::vector<Rays> batches;
  batches.emplace_back(tile_rays);
  for (std::uint32_t i = 0; i < 5; ++i) batches[0].add({{}, {0, 0, 1}}, {}, 0);
  std::vector<Answers> a, b;
  a.emplace_back(tile_rays);
  b.emplace_back(tile_rays);
  for (std::uint32_t i = 0; i < 5; ++i) {
    a[0].hits.triangle[i] = b[0].hits.triangle[i] = i;
    a[0].hits.t[i] = b[0].hits.t[i] = 1;
  }
  b[0].hits.triangle[1] = no_triangle;  // missed
  b[0].hits.triangle[2] = 9;            // coincident
  b[0].hits.triangle[3] = 9;            // elsewhere
  b[0].hits.t[3] = 1.1f;
  b[0].hits.u[4] = 0.5f;  // other bits
  const Disagreement found = compare(RayKind::primary, batches, a, b);
  EXPECT_EQ(found.rays, 5u);
  EXPECT_EQ(found.missed, 1u);
  EXPECT_EQ(found.elsewhere, 1u);
  EXPECT_EQ(found.bits, 4u);
}

TEST(TracerBench, BuildsAreTimed) {
  const Scene scene = load_scene("office");
  const TimedBuild ours = time_our_build(scene.mesh, 2);
  EXPECT_GT(ours.milliseconds, 0);
  EXPECT_GT(ours.sah_cost, 1);
  for (const TimedBuild& build : time_embree_builds(scene.mesh, 1))
    EXPECT_GT(build.milliseconds, 0);
}

}  // namespace
}  // namespace irt::tracer
