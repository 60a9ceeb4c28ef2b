#include "renderer/shading/image.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "renderer/shading/primary_rays.hpp"

namespace irt {
namespace {

// Pixels are visited in tiles of 16 x 16 and within a tile along a Z-order curve, so that any
// aligned run of 4, 8, 16 or 256 rays covers a compact block: 2 x 2, 4 x 2, 4 x 4, the whole tile.
constexpr std::uint32_t tile = 16;

/// The even bits of an 8-bit Morton number.
constexpr std::uint32_t even_bits(std::uint32_t morton) {
  return (morton & 1u) | (morton >> 1 & 2u) | (morton >> 2 & 4u) | (morton >> 3 & 8u);
}

}  // namespace

PrimaryRays::PrimaryRays(const Camera& camera, std::uint32_t width, std::uint32_t height)
    : eye_(camera.eye), forward_(normalize(camera.target - camera.eye)) {
  Vec3 sideways = cross(forward_, camera.up);
  if (!(length(sideways) > 0)) {  // looking along `up`: any other direction will do
    sideways = cross(forward_, std::abs(forward_.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
  }
  right_ = normalize(sideways);
  up_ = cross(right_, forward_);
  // The tangent may differ by a unit in the last place of a double between mathematical libraries;
  // rounded to a float it does not, but for one angle in some hundred millions.
  constexpr double radians_per_degree = 0.017453292519943295;
  half_height_ = static_cast<float>(std::tan(0.5 * camera.vertical_fov * radians_per_degree));
  half_width_ = half_height_ * static_cast<float>(width) / static_cast<float>(height);
  step_ = 2 * half_height_ / static_cast<float>(height);
}

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
  for (std::uint32_t top = 0; top < height; top += tile) {
    for (std::uint32_t left = 0; left < width; left += tile) {
      for (std::uint32_t morton = 0; morton < tile * tile; ++morton) {
        const std::uint32_t x = left + even_bits(morton), y = top + even_bits(morton >> 1);
        if (x >= width || y >= height) continue;
        if (task == nullptr || task->rays.size == rays_per_task_) {
          task = &tasks.add(TaskKind::primary, 0);
        }
        task->rays.add(rays.through(x, y, place), {weight, weight, weight}, y * width + x);
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
