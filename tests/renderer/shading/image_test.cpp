#include "renderer/shading/image.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "renderer/shading/primary_rays.hpp"
#include "renderer/shading/whitted.hpp"

namespace irt {
namespace {

TEST(PrimaryRays, MeetThePicturePlaneWhereTheirPixelIs) {
  const Camera camera{{1, 2, 3}, {1, 2, -7}, {0, 1, 0}, 90};
  const PrimaryRays rays(camera, 40, 20);
  const Ray centre = rays.through(20, 10);  // half a pixel right and below the middle
  EXPECT_EQ(centre.origin, camera.eye);
  EXPECT_NEAR(centre.direction.z, -1, 1e-6);
  EXPECT_NEAR(centre.direction.x, 0.05, 1e-6);
  EXPECT_NEAR(centre.direction.y, -0.05, 1e-6);
  const Ray corner = rays.through(0, 0);
  EXPECT_NEAR(corner.direction.x, -2 + 0.05, 1e-6);  // 90 degrees high, twice as wide
  EXPECT_NEAR(corner.direction.y, 1 - 0.05, 1e-6);
}

TEST(PrimaryRays, LookingAlongUpStillGivesAPicture) {
  const PrimaryRays rays({{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 60}, 10, 10);
  const Vec3 direction = rays.through(3, 8).direction;
  EXPECT_TRUE(std::isfinite(direction.x + direction.y + direction.z));
}

TEST(ImageRendering, EveryPixelGetsOnePrimaryRayInCompactBlocks) {
  Scene scene;
  scene.lights.resize(4);
  for (const auto& [width, height] : {std::pair{64u, 32u}, {300u, 300u}, {1u, 1u}, {17u, 3u}}) {
    const auto frame = frame_buffers().front().make(width, height);
    const Whitted shader(scene, *frame, {});
    // 100 is no multiple of a tile nor of a packet.
    const std::uint32_t rays_per_task = width == 300 ? 100 : 256;
    ImageRendering application(scene.camera, *frame, shader, rays_per_task);
    TaskPool pool(1, rays_per_task);
    TaskSink sink(pool, 0);
    application.start_frame(sink);

    const PrimaryRays rays(scene.camera, width, height);
    std::set<std::uint32_t> pixels;
    for (const Task* task : sink.finish()) {
      EXPECT_EQ(task->kind, TaskKind::primary);
      for (std::uint32_t i = 0; i < task->rays.size; ++i) {
        EXPECT_EQ(task->rays.weight(i), (Vec3{1, 1, 1}));
        const std::uint32_t pixel = task->rays.pixel[i];
        EXPECT_TRUE(pixels.insert(pixel).second);
        const Ray ray = rays.through(pixel % width, pixel / width);
        EXPECT_EQ(task->rays.ray(i).origin, ray.origin);
        EXPECT_EQ(task->rays.ray(i).direction, ray.direction) << pixel;  // to the bit
        EXPECT_EQ(task->rays.ray(i).t_max, ray.t_max);
      }
      if (width % 16 != 0 || height % 16 != 0) continue;
      for (std::uint32_t packet = 0; packet < task->rays.size; packet += 16) {  // a 4 x 4 block
        const std::uint32_t first = task->rays.pixel[packet];
        for (std::uint32_t i = packet; i < packet + 16; ++i) {
          EXPECT_LT(task->rays.pixel[i] % width - first % width, 4u);
          EXPECT_LT(task->rays.pixel[i] / width - first / width, 4u);
        }
      }
    }
    EXPECT_EQ(pixels.size(), std::size_t{width} * height);
  }
}

TEST(SamplePlace, OneIsTheCentreAndManyAreSpreadEvenly) {
  EXPECT_EQ(sample_place(0, 1).x, 0.5f);
  EXPECT_EQ(sample_place(0, 1).y, 0.5f);
  for (const std::uint32_t count : {2u, 3u, 5u, 16u, 100u, 4096u}) {
    std::set<int> columns;  // one sample in each
    float sum = 0;
    for (std::uint32_t sample = 0; sample < count; ++sample) {
      const InPixel place = sample_place(sample, count);
      columns.insert(static_cast<int>(place.x * static_cast<float>(count)));
      EXPECT_GT(place.y, 0);
      EXPECT_LT(place.y, 1);
      sum += place.y;
    }
    EXPECT_EQ(columns.size(), count);
    EXPECT_NEAR(sum / static_cast<float>(count), 0.5f, 0.1f);
  }
}

TEST(ImageRendering, RefusesWhatCouldOverflowTheFrameBuffer) {
  Scene scene;
  scene.lights.resize(20'000);
  const auto frame = frame_buffers().front().make(4, 4);
  EXPECT_NO_THROW(ImageRendering(scene.camera, *frame, Whitted(scene, *frame, {2}), 256));
  EXPECT_THROW(ImageRendering(scene.camera, *frame, Whitted(scene, *frame, {3}), 256),
               std::invalid_argument);
  const Whitted shader(scene, *frame, {0});
  EXPECT_NO_THROW(ImageRendering(scene.camera, *frame, shader, 256, 3));
  EXPECT_THROW(ImageRendering(scene.camera, *frame, shader, 256, 4), std::invalid_argument);
}

}  // namespace
}  // namespace irt
