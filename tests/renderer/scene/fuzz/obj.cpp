#include "renderer/scene/readers/obj.hpp"

#include "tests/renderer/scene/fuzz/verdict.hpp"

/// The input is an OBJ, and after a zero byte the MTL that every library it names contains.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view text = irt::fuzz::text_of(data, size);
  const std::size_t end = text.find('\0');
  const std::string library(end == text.npos ? "" : text.substr(end + 1));
  return irt::fuzz::verdict([&] {
    const irt::MeshWithMaterials result =
        irt::parse_obj(text.substr(0, end), [&](std::string_view) { return library; });
    irt::fuzz::demand_sound(result.mesh, result.materials.size());
    for (const irt::Material& material : result.materials) {
      for (int c = 0; c < 3; ++c) {
        irt::fuzz::demand(material.diffuse[c] >= 0 && material.diffuse[c] <= 1);
        irt::fuzz::demand(material.specular[c] >= 0 && material.specular[c] <= 1);
      }
    }
  });
}
