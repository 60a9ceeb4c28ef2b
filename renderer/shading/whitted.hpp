/// The thesis' shader (chapter 4): one shadow ray per light and hit, one specular ray where the
/// material reflects (Whitted 1980), without recursion.
#pragma once

#include "renderer/shading/shader.hpp"

namespace irt {

/// A ray carries its weight: the product of the BRDFs and cosines on its path. A shadow ray carries
/// the light as well, so that an unoccluded one simply adds its weight to the pixel.
///
/// Shadow rays start at the light and end just above the surface, and the rays of a task are bound
/// for one light: they share their origin, which keeps them coherent.
///
/// No ray is spent where it cannot bring light: none from a light behind the surface, none to a
/// material that is black to it.
///
/// Many hits are shaded side by side. The operations are those of `surface_at`, `Surface::lifted`
/// and `reflect` in their order, and nothing is fused: every instruction set gives the same bits.
class Whitted final : public Shader {
 public:
  /// Keeps the parts of a scene that no light reaches readable.
  static constexpr float ambient = 0.1f;
  static constexpr Vec3 background{0.08f, 0.1f, 0.14f};

  Whitted(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options)
      : scene_(scene), frame_(frame), options_(options) {}

  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const override;

  void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                    TaskSink& tasks) const override;

  /// A path has at most `max_depth` + 1 hits, each with one ray that led there and its shadow rays.
  [[nodiscard]] std::uint64_t max_rays_per_sample() const override {
    return (std::uint64_t{options_.max_depth} + 1) * rays_per_hit(scene_);
  }
  static std::uint64_t rays_per_hit(const Scene& scene) { return scene.lights.size() + 1; }

 private:
  const Scene& scene_;
  FrameBuffer& frame_;
  ShaderOptions options_;
};

}  // namespace irt
