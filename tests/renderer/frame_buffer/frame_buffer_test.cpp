#include "renderer/frame_buffer/frame_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <thread>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/frame_buffer/private_sums.hpp"

namespace irt {
namespace {

struct Contribution {
  std::uint32_t pixel;
  Vec3 value;
};

std::vector<Contribution> contributions(std::uint32_t pixels, std::size_t count) {
  std::minstd_rand random(7);
  std::uniform_real_distribution<float> light(0, 0.01f);
  std::vector<Contribution> all(count);
  for (Contribution& one : all) {
    one = {static_cast<std::uint32_t>(random() % pixels),
           {light(random), light(random), light(random)}};
  }
  return all;
}

// Adds everything with `threads` threads that interleave.
void add_all(FrameBuffer& buffer, const std::vector<Contribution>& all, unsigned threads) {
  std::vector<std::jthread> running;
  for (unsigned t = 0; t < threads; ++t) {
    running.emplace_back([&, t] {
      for (std::size_t i = t; i < all.size(); i += threads) buffer.add(all[i].pixel, all[i].value);
    });
  }
}

TEST(FrameBuffer, SumsAgreeWithASequentialSumUnderContention) {
  constexpr std::uint32_t width = 4, height = 2;
  const auto all = contributions(width * height, 20'000);
  std::vector<std::array<double, 3>> expected(width * height);
  for (const Contribution& one : all) {
    for (int c = 0; c < 3; ++c) expected[one.pixel][static_cast<std::size_t>(c)] += one.value[c];
  }
  for (const FrameBufferEntry& entry : frame_buffers()) {
    SCOPED_TRACE(entry.name);
    auto buffer = entry.make(width, height);
    add_all(*buffer, all, 4);
    for (std::uint32_t pixel = 0; pixel < width * height; ++pixel) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(buffer->sum(pixel)[c], expected[pixel][static_cast<std::size_t>(c)], 1e-3);
      }
    }
    buffer->clear();
    EXPECT_EQ(buffer->sum(3), Vec3{});
  }
}

TEST(FrameBuffer, NegativeAndNanCountAsBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const FrameBufferEntry& entry : frame_buffers()) {
    SCOPED_TRACE(entry.name);
    auto buffer = entry.make(1, 1);
    buffer->add(0, {nan, -1, 0.5f});
    EXPECT_EQ(buffer->sum(0), (Vec3{0, 0, 0.5f}));
  }
}

TEST(FrameBuffer, PictureIsTheSquareRoot) {
  FixedPointFrameBuffer buffer(2, 1);
  buffer.add(0, {0.25f, 1, 7});
  const Image image = buffer.image();
  EXPECT_EQ(image.rgb, (std::vector<std::uint8_t>{128, 255, 255, 0, 0, 0}));
}

TEST(FrameBuffer, EveryByteIsTheRoundedSquareRoot) {
  constexpr float half = 0.5f;  // the cast cuts
  for (const FrameBufferEntry& entry : frame_buffers()) {
    SCOPED_TRACE(entry.name);
    const auto buffer = entry.make(37, 11);  // no multiple of any vector
    for (std::uint32_t pixel = 0; pixel < buffer->pixels(); ++pixel) {
      const float light = static_cast<float>(pixel) / 300;  // some above 1
      buffer->add(pixel, {light, light * light, 1 - light});
    }
    const Image image = buffer->image();
    for (std::uint32_t pixel = 0; pixel < buffer->pixels(); ++pixel) {
      for (int channel = 0; channel < 3; ++channel) {
        const float clamped = std::min(buffer->sum(pixel)[channel], 1.0f);
        EXPECT_EQ(image.rgb[std::size_t{3} * pixel + static_cast<std::size_t>(channel)],
                  static_cast<std::uint8_t>(std::sqrt(clamped) * 255.0f + half))
            << pixel << " " << channel;
      }
    }
  }
}

TEST(FrameBuffer, FnvMatchesItsPublishedValues) {
  EXPECT_EQ(fnv1a({}), 0xcbf29ce484222325u);
  const std::uint8_t a[] = {'a'};
  EXPECT_EQ(fnv1a(a), 0xaf63dc4c8601ec8cu);
}

TEST(FixedPoint, BitsDoNotDependOnOrderOrThreadsOrBuffer) {
  const auto all = contributions(8, 20'000);
  FixedPointFrameBuffer forward(4, 2);
  add_all(forward, all, 1);
  for (const FrameBufferEntry& entry : frame_buffers()) {
    if (!entry.exact) continue;
    SCOPED_TRACE(entry.name);
    const auto threaded = entry.make(4, 2);
    add_all(*threaded, {all.rbegin(), all.rend()}, 8);
    EXPECT_EQ(forward.hash(), threaded->hash());
  }
}

TEST(FixedPoint, ManyContributionsAreTheSameAsOneByOne) {
  constexpr std::uint32_t count = 150, pixels = 37 * 11;
  std::minstd_rand random(3);
  std::uniform_real_distribution<float> light(-1, 300);  // some are clamped at either end
  std::uint32_t pixel[count];
  float red[count], green[count], blue[count];
  for (std::uint32_t i = 0; i < count; ++i) {
    pixel[i] = static_cast<std::uint32_t>(random() % pixels);
    red[i] = light(random);
    green[i] = i % 9 == 0 ? std::numeric_limits<float>::quiet_NaN() : light(random) / 300;
    blue[i] = i % 7 == 0 ? std::numeric_limits<float>::infinity() : light(random) * 1e-7f;
  }
  FixedPointFrameBuffer one_by_one(37, 11);
  for (std::uint32_t i = 0; i < count; ++i) {
    one_by_one.add(pixel[i], {red[i], green[i], blue[i]});
  }
  for (const FrameBufferEntry& entry : frame_buffers()) {
    if (!entry.exact) continue;
    SCOPED_TRACE(entry.name);
    const auto together = entry.make(37, 11);
    together->add(count, pixel, red, green, blue);
    EXPECT_EQ(one_by_one.hash(), together->hash());
  }
}

TEST(PrivateSums, ThreadsAndBuffersComeAndGo) {
  PrivateSumsFrameBuffer one(64, 2), other(64, 2);
  FixedPointFrameBuffer expected_one(64, 2), expected_other(64, 2);
  for (int frame = 0; frame < 3; ++frame) {
    for (FrameBuffer* buffer :
         std::initializer_list<FrameBuffer*>{&one, &other, &expected_one, &expected_other}) {
      buffer->clear();
    }
    for (int thread = 0; thread < 3; ++thread) {
      std::jthread([&] {
        for (std::uint32_t pixel = 0; pixel < 128; pixel += 5) {  // from one buffer to the other
          const Vec3 light{0.5f, static_cast<float>(frame), static_cast<float>(thread)};
          one.add(pixel, light);
          expected_one.add(pixel, light);
          other.add(pixel / 2, light * 0.5f);
          expected_other.add(pixel / 2, light * 0.5f);
        }
      }).join();
    }
    EXPECT_EQ(one.hash(), expected_one.hash());
    EXPECT_EQ(other.hash(), expected_other.hash());
  }
}

TEST(FixedPoint, OneContributionMoreChangesTheHashEvenIfBlack) {
  FixedPointFrameBuffer buffer(4, 2);
  const std::uint64_t empty = buffer.hash();
  buffer.add(5, {0, 0, 0});
  EXPECT_NE(buffer.hash(), empty);
  EXPECT_EQ(buffer.contributions(5), 1u);
  EXPECT_EQ(buffer.sum(5), Vec3{});
}

TEST(FixedPoint, TheBrightestSumsDoNotOverflow) {
  FixedPointFrameBuffer buffer(1, 1);
  const float infinity = std::numeric_limits<float>::infinity();
  const std::uint64_t most = buffer.max_contributions();
  for (std::uint64_t i = 0; i < most; ++i) buffer.add(0, {infinity, 1e30f, 256});
  const float brightest = static_cast<float>(most) * FixedPointSum::max_value;
  EXPECT_EQ(buffer.sum(0), (Vec3{brightest, brightest, brightest}));
  EXPECT_EQ(buffer.contributions(0), most);
}

}  // namespace
}  // namespace irt
