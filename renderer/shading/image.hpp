/// The application of the thesis: a picture of a scene.
#pragma once

#include <cstdint>

#include "renderer/engine/application.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"
#include "renderer/scene/scene.hpp"
#include "renderer/shading/shader.hpp"

namespace irt {

/// Shoots primary rays through every pixel, tile by tile, and lets a shader take it from there.
///
/// A frame starts with the first sample of every pixel. Who has traced a primary task makes that
/// of the next sample, so a frame needs no more memory for many samples than for one.
class ImageRendering final : public Application {
 public:
  /// Everything given outlives the application. `rays_per_task` is at most the engine's. Throws
  /// std::invalid_argument where the frame buffer could overflow.
  ImageRendering(const Camera& camera, FrameBuffer& frame, const Shader& shader,
                 std::uint32_t rays_per_task, std::uint32_t samples_per_pixel = 1);

  void start_frame(TaskSink& tasks) override;
  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) override {
    shader_.on_hits(task, hits, tasks);
    if (task.kind == TaskKind::primary && task.sample + 1 < samples_) next_sample(task, tasks);
  }
  void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                    TaskSink& tasks) override {
    shader_.on_occlusion(task, occluded, tasks);
  }
  void finish_frame() override { image_ = frame_.image(); }

  /// The last frame that was finished.
  [[nodiscard]] const Image& image() const { return image_; }

 private:
  void next_sample(const Task& task, TaskSink& tasks) const;

  const Camera& camera_;
  FrameBuffer& frame_;
  const Shader& shader_;
  std::uint32_t rays_per_task_, samples_;
  Image image_;
};

}  // namespace irt
