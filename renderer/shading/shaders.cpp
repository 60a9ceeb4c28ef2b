/// The list of shaders: a new one adds its header and its line.
#include <array>
#include <type_traits>

#include "renderer/shading/ambient_occlusion.hpp"
#include "renderer/shading/depth.hpp"
#include "renderer/shading/diffuse.hpp"
#include "renderer/shading/normals.hpp"
#include "renderer/shading/path.hpp"
#include "renderer/shading/whitted.hpp"

namespace irt {
namespace {

template <class S>
std::unique_ptr<Shader> make(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options) {
  return std::make_unique<S>(scene, frame, options);
}

template <class S>
constexpr ShaderEntry entry(std::string_view name, std::string_view summary) {
  constexpr bool whitted = std::is_same_v<S, Whitted>;
  return {.name = name,
          .summary = summary,
          .make = make<S>,
          .rays_per_hit = S::rays_per_hit,
          .takes_depth = whitted || std::is_same_v<S, PathTracer>,
          .takes_secondary = whitted};
}

constexpr std::array entries{
    entry<Whitted>("whitted", "a shadow ray per light, a specular ray where the material reflects"),
    entry<Diffuse>("diffuse", "matt colours under the lights; no rays but the primary ones"),
    entry<Normals>("normals", "which way surfaces face, as colours"),
    entry<Depth>("depth", "how far away surfaces are, in grey"),
    entry<AmbientOcclusion>("ambient-occlusion", "eight short shadow rays per hit"),
    entry<PathTracer>("path", "light of any number of reflections; wants many samples per pixel"),
};

constexpr std::array ways{
    SecondaryEntry{SecondaryRays::packed, "packed", "re-packed without gaps by kind and light"},
    SecondaryEntry{SecondaryRays::thesis, "thesis", "in the packets of the rays that led to them"},
    SecondaryEntry{SecondaryRays::single, "single", "one by one"},
};

}  // namespace

std::span<const SecondaryEntry> secondary_ways() {
  return ways;
}

std::span<const ShaderEntry> shaders() {
  return entries;
}

}  // namespace irt
