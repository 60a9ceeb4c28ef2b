#include <array>

#include "renderer/shading/whitted.hpp"

namespace irt {
namespace {

template <class S>
std::unique_ptr<Shader> make(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options) {
  return std::make_unique<S>(scene, frame, options);
}

constexpr std::array entries{
    ShaderEntry{"whitted", "a shadow ray per light, a specular ray where the material reflects",
                make<Whitted>},
};

}  // namespace

std::span<const ShaderEntry> shaders() {
  return entries;
}

}  // namespace irt
