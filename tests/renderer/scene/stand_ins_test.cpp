#include "renderer/scene/procedural/stand_ins.hpp"

#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <utility>

#include "renderer/scene/scenes.hpp"
#include "tests/renderer/scene/sound.hpp"

namespace {

using irt::Mesh;
using irt::Scene;
using irt::Vec3;

TEST(StandIns, AreSoundAndTheSameEveryTime) {
  ASSERT_FALSE(irt::built_in_scenes().empty());
  for (const irt::SceneEntry& entry : irt::built_in_scenes()) {
    SCOPED_TRACE(entry.name);
    const Scene scene = irt::load_scene(entry.name);
    EXPECT_EQ(scene.name, entry.name);
    irt::expect_sound(scene);
    EXPECT_TRUE(irt::has_mirror(scene));
    EXPECT_EQ(scene.lights.size(), 4u);
    const Scene again = entry.make();
    EXPECT_EQ(scene.mesh.vertices, again.mesh.vertices);
    EXPECT_EQ(scene.mesh.triangles, again.mesh.triangles);
  }
}

TEST(StandIns, HaveTheThesisTriangleCounts) {
  EXPECT_EQ(irt::make_bunny().mesh.triangles.size(), 69'463u);
  EXPECT_EQ(irt::make_office().mesh.triangles.size(), 20'769u);
  EXPECT_EQ(irt::make_conference().mesh.triangles.size(), 190'951u);
}

/// FNV-1a over the mesh's bytes.
std::uint64_t fingerprint(const Mesh& mesh) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto take = [&hash](std::uint32_t word) {
    for (int i = 0; i < 4; ++i) hash = (hash ^ (word >> 8 * i & 0xff)) * 0x100000001b3u;
  };
  for (const Vec3 v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) take(std::bit_cast<std::uint32_t>(v[axis]));
  }
  for (const auto& triangle : mesh.triangles) {
    for (const auto index : triangle) take(index);
  }
  for (const auto material : mesh.material) take(material);
  return hash;
}

TEST(StandIns, HaveTheSameBitsOnEveryMachineAndCompiler) {
  EXPECT_EQ(fingerprint(irt::make_bunny().mesh), 3105444792178705775u);
  EXPECT_EQ(fingerprint(irt::make_office().mesh), 5839738976773631041u);
  EXPECT_EQ(fingerprint(irt::make_conference().mesh), 5577201347320184187u);
}

TEST(StandIns, BunnyIsOneClosedSurfaceOneRepetitionAndABox) {
  const Mesh mesh = irt::make_bunny().mesh;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0;
  for (std::uint32_t i = 0; i < 69'450; ++i) {
    const auto& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    volume += dot(mesh.corner(i, 0), cross(mesh.corner(i, 1), mesh.corner(i, 2))) / 6.0;
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1) << edge.first << " - " << edge.second;
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << edge.first << " - " << edge.second;
  }
  EXPECT_GT(volume, 0.0002) << "the normals point outwards, around half a litre";
  EXPECT_EQ(mesh.triangles[69'450], mesh.triangles[0]);
}

}  // namespace
