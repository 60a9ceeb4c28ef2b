#include "renderer/shading/image.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "renderer/shading/primary_rays.hpp"

namespace irt {

ImageRendering::ImageRendering(const Camera& camera, FrameBuffer& frame, const Shader& shader,
                               std::uint32_t rays_per_task, std::uint32_t samples_per_pixel)
    : camera_(camera),
      frame_(frame),
      shader_(shader),
      rays_per_task_(rays_per_task),
      samples_(samples_per_pixel) {
  const std::uint64_t contributions = shader.max_rays_per_sample() * samples_;
  if (contributions > frame.max_contributions()) {
    throw std::invalid_argument("a pixel may get " + std::to_string(contributions) +
                                " contributions, this frame buffer holds " +
                                std::to_string(frame.max_contributions()) +
                                ": use fewer samples, fewer lights or a smaller depth");
  }
}

void ImageRendering::start_frame(TaskSink& tasks) {
  frame_.clear();
  const std::uint32_t width = frame_.width(), height = frame_.height();
  const PrimaryRays rays(camera_, width, height);
  const InPixel place = sample_place(0, samples_);
  const float weight = 1.0f / static_cast<float>(samples_);
  Task* task = nullptr;
  for (std::uint32_t top = 0; top < height; top += tile_side) {
    for (std::uint32_t left = 0; left < width; left += tile_side) {
      const bool inside = left + tile_side <= width && top + tile_side <= height;
      for (std::uint32_t morton = 0; morton < tile_side * tile_side;) {
        const std::uint32_t x = left + even_bits(morton), y = top + even_bits(morton >> 1);
        if (x >= width || y >= height) {
          ++morton;
          continue;
        }
        if (task == nullptr || task->rays.size == rays_per_task_) {
          task = &tasks.add(TaskKind::primary, 0);
        }
        const std::uint32_t room = rays_per_task_ - task->rays.size;
        const std::uint32_t run = std::min(tile_side * tile_side - morton, room) / 16 * 16;
        if (inside && run != 0) {
          rays.add_run(left, top, morton, run, place, weight, task->rays);
          morton += run;
        } else {
          task->rays.add(rays.through(x, y, place), {weight, weight, weight}, y * width + x);
          ++morton;
        }
      }
    }
  }
}

void ImageRendering::next_sample(const Task& task, TaskSink& tasks) const {
  const std::uint32_t width = frame_.width(), sample = task.sample + 1;
  const PrimaryRays rays(camera_, width, frame_.height());
  const InPixel place = sample_place(sample, samples_);
  Task& next = tasks.add(TaskKind::primary, 0, sample);
  for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
    const std::uint32_t pixel = task.rays.pixel[lane];
    next.rays.add(rays.through(pixel % width, pixel / width, place), task.rays.weight(lane), pixel);
  }
}

}  // namespace irt
