#include <cmath>

#include "renderer/scene/readers/scene_file.hpp"
#include "tests/renderer/scene/fuzz/verdict.hpp"

namespace {

/// The mesh `m`; there is no other.
irt::MeshWithMaterials load(std::string_view file) {
  if (file != "m") throw irt::SceneError("no such mesh");
  return {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {0}}, {{"own", {}, {}}}};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  return irt::fuzz::verdict([&] {
    const irt::Scene scene = irt::parse_scene(irt::fuzz::text_of(data, size), load);
    irt::fuzz::demand_sound(scene.mesh, scene.materials.size());
    irt::fuzz::demand(!scene.lights.empty());
    const irt::Vec3 view = irt::normalize(scene.camera.target - scene.camera.eye);
    const irt::Vec3 side = irt::normalize(irt::cross(view, scene.camera.up));
    for (int axis = 0; axis < 3; ++axis) irt::fuzz::demand(std::isfinite(side[axis]));
  });
}
