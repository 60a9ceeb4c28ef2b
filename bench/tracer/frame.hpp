/// A whole picture through the queue engine, whoever traces its rays.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bench/tracer/contestant.hpp"
#include "renderer/engine/engine.hpp"
#include "renderer/frame_buffer/private_sums.hpp"
#include "renderer/shading/image.hpp"

namespace irt::tracer {

/// Renders frames with one contestant: the rays are made, queued and shaded by the same code for
/// all of them, and only the accelerator differs.
class FrameBench {
 public:
  /// A square picture of `side` pixels; scene and contestant outlive the bench.
  FrameBench(const Scene& scene, std::uint32_t side, unsigned threads,
             const Contestant& contestant);

  /// Renders one frame; returns the milliseconds from its first ray to the finished image.
  double run();

  [[nodiscard]] const FrameBuffer& frame() const { return frame_; }
  /// Rays of all kinds in the last frame.
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  PrivateSumsFrameBuffer frame_;
  std::unique_ptr<Shader> shader_;
  ImageRendering application_;
  std::unique_ptr<Engine> engine_;
  std::uint64_t rays_ = 0;
};

/// The pixels whose brightest difference is more than a hundredth of white.
std::uint32_t differing_pixels(const FrameBuffer& a, const FrameBuffer& b);

}  // namespace irt::tracer
