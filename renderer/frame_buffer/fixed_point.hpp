/// The frame buffer whose sums are integers: wait-free to add to and the same to the last bit,
/// whatever the queue, the number of threads or the schedule.
#pragma once

#include <atomic>
#include <vector>

#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt {

/// A channel of a contribution is clamped to [0, 256] and cut to a multiple of 2^-24, an integer of
/// at most 2^32. The red word holds 2^16 times the sum of these integers plus the number of
/// contributions, so that even a lost task of rays that brought no light (shadow rays in the dark)
/// leaves a trace.
///
/// No overflow: with n <= 65,535 contributions a sum is at most n * 2^32 and the red word at most
/// n * 2^48 + n <= 2^64 - 2^48 + 2^16 - 1 < 2^64. `max_contributions` says so and the shader keeps
/// to it.
class FixedPointFrameBuffer final : public FrameBuffer {
 public:
  static constexpr float max_value = 256;
  static constexpr float scale = 0x1p24f;

  FixedPointFrameBuffer(std::uint32_t width, std::uint32_t height)
      : FrameBuffer(width, height), words_(std::size_t{width} * height) {}

  /// Wait-free: at most three fetch-and-adds.
  void add(std::uint32_t pixel, Vec3 value) override {
    Words& words = words_[pixel];
    const std::uint64_t green = quantize(value.y), blue = quantize(value.z);
    // Relaxed throughout: adds commute, nothing else is published through a sum, and the sums are
    // read only after the barrier that ends the frame, which orders every add before the read.
    words.red.fetch_add((quantize(value.x) << count_bits) + 1, std::memory_order_relaxed);
    if (green != 0) words.green.fetch_add(green, std::memory_order_relaxed);
    if (blue != 0) words.blue.fetch_add(blue, std::memory_order_relaxed);
  }

  using FrameBuffer::add;
  void add(std::uint32_t count, const std::uint32_t* pixel, const float* red, const float* green,
           const float* blue) override {
    for (std::uint32_t i = 0; i < count; ++i) {
      FixedPointFrameBuffer::add(pixel[i], {red[i], green[i], blue[i]});
    }
  }

  void clear() override {
    for (Words& words : words_) {
      words.red.store(0, std::memory_order_relaxed);
      words.green.store(0, std::memory_order_relaxed);
      words.blue.store(0, std::memory_order_relaxed);
    }
  }

  Vec3 sum(std::uint32_t pixel) const override {
    const Words& words = words_[pixel];
    return {to_float(words.red.load(std::memory_order_relaxed) >> count_bits),
            to_float(words.green.load(std::memory_order_relaxed)),
            to_float(words.blue.load(std::memory_order_relaxed))};
  }

  void sums(std::uint32_t first, std::uint32_t count, float* rgb) const override {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 value = FixedPointFrameBuffer::sum(first + i);
      *rgb++ = value.x;
      *rgb++ = value.y;
      *rgb++ = value.z;
    }
  }

  /// Contributions that `pixel` has got since the last clear.
  std::uint64_t contributions(std::uint32_t pixel) const {
    return words_[pixel].red.load(std::memory_order_relaxed) & count_mask;
  }

  std::uint64_t max_contributions() const override { return count_mask; }

  /// Of the integer sums, least significant byte first.
  std::uint64_t hash() const override;

 private:
  static constexpr int count_bits = 16;
  static constexpr std::uint64_t count_mask = (1u << count_bits) - 1;

  struct Words {
    std::atomic<std::uint64_t> red{0}, green{0}, blue{0};
  };

  // The product is exact, being by a power of two, and the conversion cuts alike everywhere.
  static std::uint64_t quantize(float value) {
    if (!(value > 0)) return 0;  // a NaN, too
    if (value > max_value) value = max_value;
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(value * scale));
  }

  static float to_float(std::uint64_t sum) {
    // A sum has 48 bits at most, and processors convert signed numbers faster.
    return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(sum)) / double{scale});
  }

  std::vector<Words> words_;
};

}  // namespace irt
