/// The thesis' frame buffer (3.2): float sums behind one user-space spinlock.
#pragma once

#include <atomic>
#include <vector>

#include "renderer/frame_buffer/frame_buffer.hpp"
#include "renderer/spin_wait.hpp"

namespace irt {

/// One lock for the whole buffer, taken for every contribution, as Listing 3.3 updates it per ray.
/// The low bits of a sum depend on the order of the adds.
class SpinlockFrameBuffer final : public FrameBuffer {
 public:
  using FrameBuffer::add;

  SpinlockFrameBuffer(std::uint32_t width, std::uint32_t height)
      : FrameBuffer(width, height), sums_(std::size_t{width} * height) {}

  /// Blocking.
  void add(std::uint32_t pixel, Vec3 value) override {
    const Vec3 light{value.x > 0 ? value.x : 0, value.y > 0 ? value.y : 0,
                     value.z > 0 ? value.z : 0};
    // (1) acquire: pairs with the release store (2) of the thread that held the lock before.
    for (SpinWait wait; locked_.exchange(true, std::memory_order_acquire);) {
      // Relaxed: only the exchange (1) takes the lock; until then the line is merely watched.
      while (locked_.load(std::memory_order_relaxed)) wait();
    }
    sums_[pixel] = sums_[pixel] + light;
    locked_.store(false, std::memory_order_release);  // (2) release: pairs with the acquire (1)
  }

  void clear() override { sums_.assign(sums_.size(), Vec3{}); }
  [[nodiscard]] Vec3 sum(std::uint32_t pixel) const override { return sums_[pixel]; }

 private:
  alignas(64) std::atomic<bool> locked_{false};
  alignas(64) std::vector<Vec3> sums_;
};

}  // namespace irt
