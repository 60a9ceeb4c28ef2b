/// Renders one frame, as a tool would.
#pragma once

#include "renderer/bvh/accelerator.hpp"
#include "renderer/engine/engine.hpp"
#include "renderer/shading/image.hpp"

namespace irt {

/// Renders `scene` into `frame` with the default structure and shader.
inline FrameStats render(const Scene& scene, FrameBuffer& frame, const QueueEntry& queue,
                         const EngineOptions& options = {}, const ShaderOptions& shading = {}) {
  const auto structure = accelerators().front().build(scene.mesh, {});
  const auto shader = shaders().front().make(scene, frame, shading);
  ImageRendering application(scene.camera, frame, *shader, options.rays_per_task);
  return make_engine(options, queue, *structure)->run(application);
}

}  // namespace irt
