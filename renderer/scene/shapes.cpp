#include "renderer/scene/shapes.hpp"

namespace irt {

std::uint32_t add_vertex(Mesh& mesh, Vec3 position) {
  mesh.vertices.push_back(position);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  std::uint32_t material) {
  mesh.triangles.push_back({a, b, c});
  mesh.material.push_back(material);
}

void add_box(Mesh& mesh, Vec3 lo, Vec3 hi, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned corner = 0; corner < 8; ++corner) {
    mesh.vertices.push_back(
        {corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z});
  }
  constexpr std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& side : sides) {
    add_triangle(mesh, first + side[0], first + side[1], first + side[2], material);
    add_triangle(mesh, first + side[0], first + side[2], first + side[3], material);
  }
}

}  // namespace irt
