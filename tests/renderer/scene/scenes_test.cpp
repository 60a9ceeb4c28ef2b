#include "renderer/scene/scenes.hpp"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>

#include "tests/renderer/scene/sound.hpp"

namespace {

namespace fs = std::filesystem;
using irt::load_scene;
using irt::Scene;

/// A folder for one test, gone after it.
class Scenes : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "irt-scenes-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }

  /// The message with which a scene is refused.
  static std::string refusal(const std::string& name) {
    try {
      load_scene(name);
    } catch (const irt::SceneError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return error.what();
    }
    return "(no refusal)";
  }

  fs::path folder_;
  const std::string obj_ = "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
};

#define EXPECT_REFUSED(name, part) \
  EXPECT_NE(refusal(name).find(part), std::string::npos) << refusal(name)

TEST_F(Scenes, ABareMeshGetsLightsAndACameraThatSeesIt) {
  write("paint.mtl", "newmtl red\nKd 1 0 0\nKs 0.5 0.5 0.5\n");
  const Scene scene = load_scene(write("thing.obj", obj_));
  EXPECT_EQ(scene.name, "thing");
  irt::expect_sound(scene);
  EXPECT_TRUE(irt::has_mirror(scene));
  EXPECT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(scene.materials[scene.mesh.material[0]].name, "red");
  EXPECT_EQ(scene.camera.target, (irt::Vec3{0.5f, 0.5f, 0}));
}

TEST_F(Scenes, AMissingLibraryLeavesTheMeshGrey) {
  const Scene scene = load_scene(write("thing.obj", obj_));
  EXPECT_EQ(scene.materials[scene.mesh.material[0]].name, "default");
}

TEST_F(Scenes, ASceneFileFindsItsMeshBesideIt) {
  fs::create_directory(folder_ / "sub");
  write("sub/thing.obj", obj_);
  const Scene scene = load_scene(write("room.json", R"({"meshes": ["sub/thing.obj"]})"));
  EXPECT_EQ(scene.name, "room");
  irt::expect_sound(scene);
}

TEST_F(Scenes, WhatCannotBeReadIsRefused) {
  EXPECT_REFUSED("bunnny", "'bunnny' is unknown; give a .json, .ply or .obj file, or one of bunny");
  EXPECT_REFUSED("", "'' is unknown");
  EXPECT_REFUSED("evil\nname", "'evil?name' is unknown");
  EXPECT_REFUSED(folder_ / "no.ply", "there is no such file");
  EXPECT_REFUSED(folder_ / "no.json", "there is no such file");
  fs::create_directory(folder_ / "dir.ply");
  EXPECT_REFUSED(folder_ / "dir.ply", "is a directory");
  ASSERT_EQ(mkfifo((folder_ / "pipe.obj").c_str(), 0600), 0);
  EXPECT_REFUSED(folder_ / "pipe.obj", "is no regular file");
  EXPECT_REFUSED(write("empty.ply", ""), "no PLY file");
  EXPECT_REFUSED(write("a.json", R"({"meshes": ["no.ply"]})"), "set IRT_SCENES");
  EXPECT_REFUSED(write("b.json", R"({"meshes": ["b.json"]})"), ".ply or .obj");
  const std::string huge = write("huge.ply", "ply");
  fs::resize_file(huge, std::uintmax_t{1} << 40);
  EXPECT_REFUSED(huge, "at most 4 GiB");
}

TEST_F(Scenes, AFileWithoutPermissionIsRefused) {
  const std::string locked = write("locked.obj", obj_);
  fs::permissions(locked, fs::perms::none);
  if (std::ifstream(locked)) GTEST_SKIP() << "root reads every file";
  EXPECT_REFUSED(locked, "permissions");
}

/// The counts that docs/scenes.md states.
TEST_F(Scenes, TheRealOnesHaveTheirTriangles) {
  const std::pair<const char*, std::size_t> counts[] = {
      {"real-bunny", 69'451 + 12}, {"real-office", 22'428}, {"real-conference", 331'179}};
  if (!fs::exists(irt::scene_data_folder() / "bunny")) {
    GTEST_SKIP() << "the real scenes are not in " << irt::scene_data_folder()
                 << "; set IRT_SCENES to their folder";
  }
  for (const auto& [name, triangles] : counts) {
    const Scene scene = load_scene(name);
    EXPECT_EQ(scene.name, name);
    EXPECT_EQ(scene.mesh.triangles.size(), triangles);
    EXPECT_EQ(scene.lights.size(), 4u);
    EXPECT_TRUE(irt::has_mirror(scene));
    irt::expect_sound(scene);
  }
}

TEST_F(Scenes, WithoutDataTheRealOnesSayWhereTheyLooked) {
  const char* before = std::getenv("IRT_SCENES");
  const std::string kept = before != nullptr ? before : "";
  setenv("IRT_SCENES", folder_.c_str(), 1);
  for (const irt::SceneEntry& entry : irt::real_scenes()) {
    EXPECT_REFUSED(std::string(entry.name), "set IRT_SCENES");
  }
  setenv("IRT_SCENES", kept.c_str(), 1);
}

}  // namespace
