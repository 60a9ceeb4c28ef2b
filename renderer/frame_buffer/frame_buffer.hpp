/// Where the contributions of all rays meet: one sum of linear RGB per pixel.
///
/// Every ray that a frame traces adds exactly one contribution to its pixel, a black one where it
/// brings no light. Contributions are linear, so their order does not matter; how the concurrent
/// sums are kept apart is what the implementations differ in.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "renderer/scene/vec3.hpp"

namespace irt {

/// An 8-bit picture with gamma 2, rows from the top, three bytes per pixel.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

class FrameBuffer {
 public:
  FrameBuffer(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {}
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;
  virtual ~FrameBuffer() = default;

  /// Adds `value` to `pixel`, which is less than width * height. Any number of threads at once.
  /// Each channel is clamped at 0 from below; a NaN counts as 0.
  virtual void add(std::uint32_t pixel, Vec3 value) = 0;

  /// `add` of many: contribution i goes to pixel[i] and has the channels red[i], green[i], blue[i].
  virtual void add(std::uint32_t count, const std::uint32_t* pixel, const float* red,
                   const float* green, const float* blue) {
    for (std::uint32_t i = 0; i < count; ++i) add(pixel[i], {red[i], green[i], blue[i]});
  }

  /// Sets every sum to zero. No other call runs at the same time.
  virtual void clear() = 0;

  /// The sum at `pixel`. No add runs at the same time.
  [[nodiscard]] virtual Vec3 sum(std::uint32_t pixel) const = 0;

  /// `sum` of `count` pixels from `first` on, red, green and blue of one after the other.
  virtual void sums(std::uint32_t first, std::uint32_t count, float* rgb) const {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 value = sum(first + i);
      for (int channel = 0; channel < 3; ++channel) *rgb++ = value[channel];
    }
  }

  /// How many contributions a pixel may get between two clears.
  [[nodiscard]] virtual std::uint64_t max_contributions() const {
    return std::numeric_limits<std::uint64_t>::max();
  }

  /// A 64-bit FNV-1a hash of the 8-bit picture, or of the exact sums where they do not depend on
  /// the order of the adds (`FrameBufferEntry::exact`).
  [[nodiscard]] virtual std::uint64_t hash() const;

  /// The picture, each channel clamped to [0, 1]. The gamma is 2 because a square root, unlike a
  /// power, is rounded alike on every machine.
  [[nodiscard]] Image image() const;

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  [[nodiscard]] std::uint32_t pixels() const { return width_ * height_; }

 private:
  std::uint32_t width_, height_;
};

/// 64-bit FNV-1a (Fowler, Noll, Vo) over `bytes`, going on from `state`.
std::uint64_t fnv1a(std::span<const std::uint8_t> bytes,
                    std::uint64_t state = 0xcbf2'9ce4'8422'2325u);

/// A frame buffer by name, as the tools see it.
struct FrameBufferEntry {
  std::string_view name;
  std::string_view summary;
  bool exact;  ///< the sums, and so the hash, do not depend on the order of the adds
  std::unique_ptr<FrameBuffer> (*make)(std::uint32_t width, std::uint32_t height);
};

/// All frame buffers, the default first.
std::span<const FrameBufferEntry> frame_buffers();

}  // namespace irt
