#include "bench/tracer/frame.hpp"

#include <cmath>

#include "queues/registry.hpp"

namespace irt::tracer {
namespace {

constexpr std::uint32_t rays_per_task = 256;

}  // namespace

FrameBench::FrameBench(const Scene& scene, std::uint32_t side, unsigned threads,
                       const Contestant& contestant)
    : frame_(side, side),
      shader_(shaders().front().make(scene, frame_, {})),
      application_(scene.camera, frame_, *shader_, rays_per_task),
      engine_(make_engine({.threads = threads, .rays_per_task = rays_per_task},
                          QueueRegistry().first(), *contestant.accelerator)) {}

double FrameBench::run() {
  const FrameStats stats = engine_->run(application_);
  rays_ = stats.rays();
  return stats.seconds() * 1e3;
}

std::uint32_t differing_pixels(const FrameBuffer& a, const FrameBuffer& b) {
  std::uint32_t differing = 0;
  for (std::uint32_t pixel = 0; pixel < a.pixels(); ++pixel) {
    const Vec3 difference = a.sum(pixel) - b.sum(pixel);
    differing += std::abs(difference.x) > 0.01f || std::abs(difference.y) > 0.01f ||
                 std::abs(difference.z) > 0.01f;
  }
  return differing;
}

}  // namespace irt::tracer
