#include "renderer/shading/whitted.hpp"

#include <gtest/gtest.h>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/shading/primary_rays.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/shading/render.hpp"

namespace irt {
namespace {

constexpr float ambient = Whitted::ambient;

TEST(Whitted, AMattWallReflectsByTheCosine) {
  const Scene scene = wall();
  FixedPointFrameBuffer frame(3, 3);
  const FrameStats stats = render(scene, frame, plain_queue);
  expect_near(frame.sum(4), scene.materials[0].diffuse * (1 + ambient), 1e-6f);
  // The neighbour's centre is 2/3 * 10 * tan(10 degrees) aside.
  const float aside = 1.175513f, cosine = 8 / std::sqrt(64 + aside * aside);
  expect_near(frame.sum(3), scene.materials[0].diffuse * (cosine + ambient), 1e-5f);
  EXPECT_EQ(stats.total().rays[0], 9u);
  EXPECT_EQ(stats.total().rays[1], 9u);
  EXPECT_EQ(stats.total().rays[2], 0u);
}

TEST(Whitted, WhatStandsBetweenCastsAShadow) {
  Scene scene = wall();
  add_square(scene, 0.1f, 7.5f,
             0);  // hidden from the eye at the side pixels, over the light's cone
  scene.camera.eye = {3, 0, 4};
  scene.camera.target = {0, 0, 0};
  FixedPointFrameBuffer frame(1, 1);
  render(scene, frame, plain_queue);
  expect_near(frame.sum(0), scene.materials[0].diffuse * ambient, 1e-6f);
}

TEST(Whitted, ALightBehindTheSurfaceBringsNothingAndCostsNothing) {
  Scene scene = wall();
  scene.lights[0].position = {0, 0, -8};
  FixedPointFrameBuffer frame(1, 1);
  const FrameStats stats = render(scene, frame, plain_queue);
  expect_near(frame.sum(0), scene.materials[0].diffuse * ambient, 1e-6f);
  EXPECT_EQ(stats.total().rays[1], 0u);
}

TEST(Whitted, AMirrorShowsWhatIsBehindTheEye) {
  Scene scene = wall();
  scene.mesh.material.assign(2, 1);
  FixedPointFrameBuffer nothing(1, 1);
  render(scene, nothing, plain_queue);
  expect_near(nothing.sum(0), Whitted::background * 0.5f, 1e-6f);

  add_square(scene, 100, 20, 0);
  FixedPointFrameBuffer frame(1, 1);
  const FrameStats stats = render(scene, frame, plain_queue);
  expect_near(frame.sum(0), scene.materials[0].diffuse * (0.5f * (1 + ambient)), 1e-6f);
  EXPECT_EQ(stats.total().rays[2], 1u);
}

TEST(Whitted, MirrorsFacingEachOtherEndAtTheDepthLimit) {
  Scene scene = wall();
  scene.mesh.material.assign(2, 1);
  add_square(scene, 100, 20, 1);
  for (const std::uint32_t depth : {0u, 1u, 7u}) {
    FixedPointFrameBuffer frame(1, 1);
    const FrameStats stats = render(scene, frame, plain_queue, {}, {.max_depth = depth});
    EXPECT_EQ(stats.total().rays[2], depth);
    EXPECT_EQ(frame.contributions(0), 1 + depth);
  }
}

TEST(Whitted, EveryRayContributesOnce) {
  Scene scene = wall();
  scene.materials[0].specular = {0.3f, 0.3f, 0.3f};
  scene.lights.push_back({{5, 5, 3}, {1, 0, 0}});
  add_square(scene, 1, 2, 0);
  FixedPointFrameBuffer frame(16, 16);
  const FrameStats stats = render(scene, frame, plain_queue, {.rays_per_task = 10});
  std::uint64_t contributions = 0;
  for (std::uint32_t pixel = 0; pixel < frame.pixels(); ++pixel) {
    contributions += frame.contributions(pixel);
  }
  EXPECT_EQ(contributions, stats.rays());
}

TEST(Whitted, SurfacesDoNotShadeThemselvesAtAnyScale) {
  // Slanted and far from the origin, every triangle three times, lit at all angles.
  for (const float scale : {1e-4f, 1.0f, 3e4f}) {
    Scene scene;
    scene.materials = {{"matt", {1, 1, 1}, {}}};
    const Vec3 corner = Vec3{7, -3, 11} * scale, side = Vec3{3, 1, 0.5f} * scale,
               up = Vec3{-1, 2, 4} * scale;
    constexpr unsigned steps = 12;
    for (unsigned i = 0; i <= steps; ++i) {
      for (unsigned k = 0; k <= steps; ++k) {
        scene.mesh.vertices.push_back(corner + side * (static_cast<float>(i) / steps) +
                                      up * (static_cast<float>(k) / steps));
      }
    }
    for (int copy = 0; copy < 3; ++copy) {
      for (unsigned i = 0; i < steps; ++i) {
        for (unsigned k = 0; k < steps; ++k) {
          const unsigned a = i * (steps + 1) + k, b = a + steps + 1;
          scene.mesh.triangles.push_back({a, b, b + 1});
          scene.mesh.triangles.push_back({a, b + 1, a + 1});
        }
      }
    }
    scene.mesh.material.assign(scene.mesh.triangles.size(), 0);
    const Vec3 middle = corner + side * 0.5f + up * 0.5f, normal = normalize(cross(side, up));
    const float size = length(side);
    // From straight above down to three degrees over the surface.
    for (const float height : {1.0f, 0.3f, 0.05f}) {
      scene.lights.push_back({middle + normal * (size * height) + side * (1 - height), {1, 1, 1}});
    }
    scene.camera = {middle + normal * (2 * size), middle, up, 20};

    FixedPointFrameBuffer frame(64, 64);
    const FrameStats stats = render(scene, frame, plain_queue);
    EXPECT_EQ(stats.total().rays[1], 3u * 64 * 64);
    // Nothing stands above the surface, so each pixel is at least as bright as light from above
    // alone makes it; a shadow upon itself would leave a hole.
    for (std::uint32_t pixel = 0; pixel < frame.pixels(); ++pixel) {
      const Ray ray = PrimaryRays(scene.camera, 64, 64).through(pixel % 64, pixel / 64);
      const float t = dot(middle - ray.origin, normal) / dot(ray.direction, normal);
      const Vec3 point = ray.origin + ray.direction * t;
      float expected = ambient;
      for (const PointLight& light : scene.lights) {
        const Vec3 way = light.position - point;
        expected += dot(normal, way) / length(way);
      }
      ASSERT_NEAR(frame.sum(pixel).x, expected, 2e-3) << "scale " << scale << " pixel " << pixel;
    }
  }
}

}  // namespace
}  // namespace irt
