/// Float sums, each added to by compare-and-swap. The thesis (3.2) wished for a hardware add on
/// floats in memory; x86 still has none.
#pragma once

#include <atomic>
#include <vector>

#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt {

/// The low bits of a sum depend on the order of the adds.
class AtomicFloatFrameBuffer final : public FrameBuffer {
 public:
  using FrameBuffer::add;

  AtomicFloatFrameBuffer(std::uint32_t width, std::uint32_t height)
      : FrameBuffer(width, height), sums_(std::size_t{width} * height * 3) {}

  /// Lock-free: a failed compare-and-swap means that another add succeeded.
  void add(std::uint32_t pixel, Vec3 value) override {
    for (int channel = 0; channel < 3; ++channel) {
      if (!(value[channel] > 0)) continue;  // adds nothing, or is a NaN
      // Relaxed: the sums are read only after the barrier that ends the frame.
      at(pixel, channel).fetch_add(value[channel], std::memory_order_relaxed);
    }
  }

  void clear() override {
    for (auto& sum : sums_) sum.store(0, std::memory_order_relaxed);
  }

  [[nodiscard]] Vec3 sum(std::uint32_t pixel) const override {
    const std::size_t first = std::size_t{pixel} * 3;
    return {sums_[first].load(std::memory_order_relaxed),
            sums_[first + 1].load(std::memory_order_relaxed),
            sums_[first + 2].load(std::memory_order_relaxed)};
  }

 private:
  std::atomic<float>& at(std::uint32_t pixel, int channel) {
    return sums_[std::size_t{pixel} * 3 + static_cast<std::size_t>(channel)];
  }

  std::vector<std::atomic<float>> sums_;
};

}  // namespace irt
