/// What a shader does: it turns the answers of rays into light at pixels and into further rays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "renderer/engine/task.hpp"
#include "renderer/engine/task_pool.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"
#include "renderer/scene/scene.hpp"

namespace irt {

/// How secondary rays travel: the thesis' question whether packets or single rays suit them.
enum class SecondaryRays : std::uint8_t {
  packed,  ///< in packets of their own, without gaps, one task per light and for mirrored rays
  thesis,  ///< in the lanes of the rays that led to them; lanes without a ray weigh nothing
  single,  ///< as `packed`, but traced ray by ray
};

/// A way by name, as the tools see it.
struct SecondaryEntry {
  SecondaryRays how;
  std::string_view name;
  std::string_view summary;
};

/// All ways, the default first.
std::span<const SecondaryEntry> secondary_ways();

struct ShaderOptions {
  /// Bounces after which a path ends. The thesis calls its ray trees shallow.
  std::uint32_t max_depth = 4;
  /// How `whitted` sends its secondary rays on. The picture is the same to the bit.
  SecondaryRays secondary = SecondaryRays::packed;
};

/// Every ray given to a shader adds exactly one contribution to its pixel, if only a black one.
/// Methods are called by any number of threads at once.
class Shader {
 public:
  Shader() = default;
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  virtual ~Shader() = default;

  /// Takes what the rays of a primary or specular task met first.
  virtual void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const = 0;

  /// Takes which rays of a shadow task met anything: 1 or 0 per ray.
  virtual void on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                            TaskSink& tasks) const = 0;

  /// The most rays that one sample of a pixel can cost, and so the most contributions that the
  /// pixel can get from it.
  [[nodiscard]] virtual std::uint64_t max_rays_per_sample() const = 0;
};

/// A shader by name, as the tools see it: a class with a constructor like `make` and a static
/// `rays_per_hit`. Scene and frame buffer outlive the shader.
struct ShaderEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Shader> (*make)(const Scene& scene, FrameBuffer& frame,
                                  const ShaderOptions& options);
  /// The most rays that one hit sends on, which says how much memory a frame may need.
  std::uint64_t (*rays_per_hit)(const Scene& scene);
  // Which of the options it does something with.
  bool takes_depth = false;
  bool takes_secondary = false;
};

/// All shaders, the default first.
std::span<const ShaderEntry> shaders();

}  // namespace irt
