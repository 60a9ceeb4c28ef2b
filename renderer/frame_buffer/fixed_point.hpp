/// Sums of light in integers: the same to the last bit, whatever the order of the adds.
#pragma once

#include <algorithm>
#include <atomic>
#include <vector>

#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt {

/// Contributions to one pixel. A channel of a contribution is clamped to [0, 256] and cut to a
/// multiple of 2^-24, an integer of at most 2^32. The red word holds 2^16 times the sum of these
/// integers plus the number of contributions, so that even a lost task of rays that brought no
/// light (shadow rays in the dark) leaves a trace.
///
/// No overflow: with n <= 65,535 contributions a sum is at most n * 2^32 and the red word at most
/// n * 2^48 + n <= 2^64 - 2^48 + 2^16 - 1 < 2^64.
struct FixedPointSum {
  static constexpr float max_value = 256;
  static constexpr float scale = 0x1p24f;
  static constexpr std::uint64_t max_contributions = 0xffff;

  std::uint64_t red = 0, green = 0, blue = 0;

  /// A channel of a contribution as an integer.
  static std::uint64_t quantize(float light) {
    const float positive = light > 0 ? light : 0;  // a NaN, too
    const float clamped = positive < max_value ? positive : max_value;
    // The product is exact, being by a power of two, and the conversion cuts alike everywhere.
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(clamped * scale));
  }
  /// A single contribution.
  static FixedPointSum of(Vec3 light) {
    return of_integers(quantize(light.x), quantize(light.y), quantize(light.z));
  }
  /// The same of channels that `quantize` has made.
  static FixedPointSum of_integers(std::uint64_t red, std::uint64_t green, std::uint64_t blue) {
    return {(red << count_bits) + 1, green, blue};
  }
  FixedPointSum& operator+=(const FixedPointSum& other) {
    red += other.red;
    green += other.green;
    blue += other.blue;
    return *this;
  }
  [[nodiscard]] Vec3 light() const {
    return {to_float(red >> count_bits), to_float(green), to_float(blue)};
  }
  [[nodiscard]] std::uint64_t contributions() const { return red & max_contributions; }

 private:
  static constexpr int count_bits = 16;

  static float to_float(std::uint64_t sum) {
    // A sum has 48 bits at most, and processors convert signed numbers faster.
    return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(sum)) / double{scale});
  }
};

/// A frame buffer whose sums are `FixedPointSum`s; where they are kept is what differs.
class ExactFrameBuffer : public FrameBuffer {
 public:
  using FrameBuffer::FrameBuffer;

  [[nodiscard]] Vec3 sum(std::uint32_t pixel) const final { return exact(pixel).light(); }
  void sums(std::uint32_t first, std::uint32_t count, float* rgb) const final {
    FixedPointSum some[at_once];
    for (std::uint32_t done = 0; done < count; done += at_once) {
      const std::uint32_t now = std::min(at_once, count - done);
      fetch(first + done, now, some);
      for (std::uint32_t i = 0; i < now; ++i) {
        const Vec3 light = some[i].light();
        for (int channel = 0; channel < 3; ++channel) *rgb++ = light[channel];
      }
    }
  }
  /// Contributions that `pixel` has got since the last clear.
  [[nodiscard]] std::uint64_t contributions(std::uint32_t pixel) const {
    return exact(pixel).contributions();
  }
  [[nodiscard]] std::uint64_t max_contributions() const final {
    return FixedPointSum::max_contributions;
  }
  /// Of the integers, least significant byte first.
  [[nodiscard]] std::uint64_t hash() const final;

 protected:
  static constexpr std::uint32_t at_once = 64;  ///< the most pixels in a call of `fetch`

  /// The sums of `count` pixels from `first` on. No add runs at the same time.
  virtual void fetch(std::uint32_t first, std::uint32_t count, FixedPointSum* sums) const = 0;

 private:
  [[nodiscard]] FixedPointSum exact(std::uint32_t pixel) const {
    FixedPointSum sum;
    fetch(pixel, 1, &sum);
    return sum;
  }
};

/// One sum per pixel, shared by all threads.
class FixedPointFrameBuffer final : public ExactFrameBuffer {
 public:
  FixedPointFrameBuffer(std::uint32_t width, std::uint32_t height)
      : ExactFrameBuffer(width, height), words_(std::size_t{width} * height) {}

  /// Wait-free: at most three fetch-and-adds.
  void add(std::uint32_t pixel, Vec3 value) override {
    Words& words = words_[pixel];
    const FixedPointSum more = FixedPointSum::of(value);
    // Relaxed throughout: adds commute, nothing else is published through a sum, and the sums are
    // read only after the barrier that ends the frame, which orders every add before the read.
    words.red.fetch_add(more.red, std::memory_order_relaxed);
    if (more.green != 0) words.green.fetch_add(more.green, std::memory_order_relaxed);
    if (more.blue != 0) words.blue.fetch_add(more.blue, std::memory_order_relaxed);
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

 private:
  void fetch(std::uint32_t first, std::uint32_t count, FixedPointSum* sums) const override {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Words& words = words_[first + i];
      sums[i] = {words.red.load(std::memory_order_relaxed),
                 words.green.load(std::memory_order_relaxed),
                 words.blue.load(std::memory_order_relaxed)};
    }
  }

  struct Words {
    std::atomic<std::uint64_t> red{0}, green{0}, blue{0};
  };
  std::vector<Words> words_;
};

}  // namespace irt
