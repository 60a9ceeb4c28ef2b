#include <bit>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include "renderer/scene/readers/derive.hpp"
#include "renderer/scene/readers/input.hpp"
#include "renderer/scene/readers/obj.hpp"
#include "renderer/scene/readers/ply.hpp"
#include "renderer/scene/readers/scene_file.hpp"

namespace {

using irt::Mesh;
using irt::MeshWithMaterials;
using irt::Scene;
using irt::TriangleIndices;
using irt::Vec3;

/// Appends numbers to a binary PLY, in the byte order asked for.
class Bytes {
 public:
  explicit Bytes(bool big_endian) : big_endian_(big_endian) {}
  template <class T>
  Bytes& operator<<(T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big_endian_) std::reverse(raw, raw + sizeof value);
    text_.append(raw, sizeof value);
    return *this;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  bool big_endian_;
  std::string text_;
};

/// A quadrilateral and a triangle, between things to skip.
std::string header(const std::string& format, const std::string& line_end = "\n") {
  std::string text;
  for (const std::string& line :
       {std::string("ply"), "format " + format + " 1.0", std::string("comment made by hand"),
        std::string("element camera 1"), std::string("property list uchar float view"),
        std::string("element vertex 5"), std::string("property float confidence"),
        std::string("property float x"), std::string("property double y"),
        std::string("property short z"), std::string("property list ushort int marks"),
        std::string("obj_info nothing"), std::string("element face 2"),
        std::string("property uchar red"), std::string("property list uchar uint vertex_indices"),
        std::string("element edge 1"), std::string("property int vertex1"),
        std::string("end_header")}) {
    text += line + line_end;
  }
  return text;
}

std::string ascii_ply(const std::string& line_end = "\n") {
  std::string text = header("ascii", line_end);
  for (const char* line : {"2 0.5 1.5", "1 0 0 0 0", "1 1 0 0 2 7 8", "1 1 1 0 0", "1 0 1 0 0",
                           "1 0.5 2.25 -3 1 9", "200 4 0 1 2 3", "201 3 3 2 4", "5"}) {
    text += line + line_end;
  }
  return text;
}

std::string binary_ply(bool big_endian) {
  Bytes body(big_endian);
  body << std::uint8_t{2} << 0.5f << 1.5f;
  const auto vertex = [&body](float x, double y, std::int16_t z) -> Bytes& {
    return body << 1.0f << x << y << z;
  };
  vertex(0, 0, 0) << std::uint16_t{0};
  vertex(1, 0, 0) << std::uint16_t{2} << 7 << 8;
  vertex(1, 1, 0) << std::uint16_t{0};
  vertex(0, 1, 0) << std::uint16_t{0};
  vertex(0.5f, 2.25, -3) << std::uint16_t{1} << 9;
  body << std::uint8_t{200} << std::uint8_t{4} << 0u << 1u << 2u << 3u;
  body << std::uint8_t{201} << std::uint8_t{3} << 3u << 2u << 4u;
  body << 5;
  return header(big_endian ? "binary_big_endian" : "binary_little_endian") + body.text();
}

void expect_the_house(const Mesh& mesh) {
  EXPECT_EQ(mesh.vertices,
            (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 2.25f, -3}}));
  EXPECT_EQ(mesh.triangles, (std::vector<TriangleIndices>{{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}));
  EXPECT_EQ(mesh.material, (std::vector<std::uint32_t>{0, 0, 0}));
}

TEST(Ply, AllEncodingsGiveTheSameMesh) {
  expect_the_house(irt::parse_ply(ascii_ply()));
  expect_the_house(irt::parse_ply(ascii_ply("\r\n")));
  expect_the_house(irt::parse_ply(binary_ply(false)));
  expect_the_house(irt::parse_ply(binary_ply(true)));
}

TEST(Ply, EveryCutOffFileIsRefused) {
  for (const std::string& whole : {ascii_ply(), binary_ply(false), binary_ply(true)}) {
    // The last element is one number of up to four bytes, of which "5" and the line end are two.
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
      EXPECT_THROW(irt::parse_ply(whole.substr(0, size)), irt::SceneError) << size;
    }
  }
}

/// The message with which `read` refuses its input.
template <class Read>
std::string refusal(Read read) {
  try {
    read();
  } catch (const irt::SceneError& error) {
    return error.what();
  }
  return "(no refusal)";
}

struct BadCase {
  const char* text;
  const char* message;  ///< a part of it
};

void expect_refusal(const BadCase& bad, const std::string& message) {
  EXPECT_NE(message.find(bad.message), std::string::npos) << bad.text << "\ngave: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), 400u) << message;
}

/// A PLY of one triangle with these lines for its header's elements and its body.
std::string triangle_ply(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

TEST(Ply, FrozenBadHeaders) {
  const BadCase cases[] = {
      {"", "no PLY file"},
      {"#?RADIANCE\n", "no PLY file"},
      {"ply", "cut off"},
      {"ply\nend_header\n", "no line 'format"},
      {"ply\nformat binary_middle_endian 1.0\nend_header\n", "it is ascii, binary_little_endian"},
      {"ply\nformat ascii 1.0\nelement vertex -3\n", "0 or more"},
      {"ply\nformat ascii 1.0\nelement vertex nan\n", "0 or more"},
      {"ply\nformat ascii 1.0\nelement vertex\n", "not a number"},
      {"ply\nformat ascii 1.0\nelement vertex 1e400\n", "beyond what a number can hold"},
      {"ply\nformat ascii 1.0\nproperty float x\n", "before any element"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty quaternion x\n", "no PLY type"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n", "it is an integer"},
      {"ply\nformat ascii 1.0\n\x01x evil\n", "'?x' is no PLY keyword"},
      {"ply\nformat ascii 1.0\nend_header\n", "no faces"},
      {"ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_indices\nend_header\n3",
       "before the vertices"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n"
       "0 0\n",
       "need one property 'z'"},
  };
  for (const BadCase& bad : cases) {
    expect_refusal(bad, refusal([&] { irt::parse_ply(bad.text); }));
  }
}

TEST(Ply, FrozenBadBodies) {
  const std::string vertices =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string good = "0 0 0 1 0 0 0 1 0\n";
  EXPECT_EQ(irt::parse_ply(triangle_ply(vertices + faces, good + "3 0 1 2")).triangles.size(), 1u);
  const BadCase cases[] = {
      {"3 0 1 3", "vertex index 3; there are 3 vertices"},
      {"3 0 1 -1", "vertex index -1"},
      {"3 0 1 1.5", "vertex index 1.5"},
      {"3 0 1 1e30", "vertex index 1e+30"},
      {"3 0 1 nan", "vertex index nan"},
      {"3 0", "length 3; the rest of the file holds"},
      {"3 0 1", "ends too early"},
      {"3 0 1     ", "ends too early"},
      {"2 0 1  ", "2 corners"},
      {"-3 0 1 2", "length -3"},
      {"2.5 0 1 2", "whole number"},
      {"inf 0 1 2", "length inf"},
      {"4000000000 0 1 2", "the rest of the file holds"},
      {"3 0 one 2", "'one', not a number"},
  };
  for (const BadCase& bad : cases) {
    expect_refusal(
        bad, refusal([&] { irt::parse_ply(triangle_ply(vertices + faces, good + bad.text)); }));
  }
  for (const char* bad : {"nan", "-inf", "1e13", "1e300"}) {
    const std::string body = std::string("0 0 ") + bad + " 1 0 0 0 1 0\n3 0 1 2";
    expect_refusal({bad, "vertex 0 has the coordinate"},
                   refusal([&] { irt::parse_ply(triangle_ply(vertices + faces, body)); }));
  }
}

TEST(Ply, CountsOfTheHeaderAreNotBelieved) {
  // Each would ask for terabytes, or for ages of skipping nothing.
  const BadCase cases[] = {
      {"element vertex 4000000000000\nproperty float x\nproperty float y\nproperty float z\n",
       "more than the file holds"},
      {"element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 9000000000000000\nproperty list uchar int vertex_indices\n",
       "more than the file holds"},
      {"element ghost 9000000000000000\n", "no faces"},
      {"element ghost 9000000000000000\nproperty list uchar int x\n", "more than the file holds"},
  };
  for (const BadCase& bad : cases) {
    expect_refusal(bad, refusal([&] { irt::parse_ply(triangle_ply(bad.text, "0 0 0\n")); }));
  }
}

std::string no_library(std::string_view) {
  return {};
}

TEST(Obj, FacesMaterialsAndFans) {
  const auto library = [](std::string_view file) -> std::string {
    EXPECT_EQ(file, "paint.mtl");
    return "newmtl red paint\nKd 0.5 0.25 nonsense\nKs 2 -1 0.125\n\nnewmtl matt\nKd 1 1 1\n"
           "Ks 0.5 0.5 0.5\nillum 2\n";
  };
  const MeshWithMaterials result = irt::parse_obj(
      "# a house\r\nmtllib paint.mtl\r\nmtllib paint.mtl\r\no house\nv 0 0 0\nv 1 0 0 1.0\n"
      "v +1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1 2 3\nusemtl red paint  \n"
      "f 1/1/1 2//1 3/1 -1 # with a note\ns off\nusemtl matt\nv .5 2.25 -3e0\nf 4 3 5\n"
      "usemtl unheard of\nf 1 2 3",
      library);
  expect_the_house({result.mesh.vertices,
                    {result.mesh.triangles.begin() + 1, result.mesh.triangles.begin() + 4},
                    {0, 0, 0}});
  EXPECT_EQ(result.mesh.material, (std::vector<std::uint32_t>{0, 1, 1, 2, 0}));
  ASSERT_EQ(result.materials.size(), 3u);
  EXPECT_EQ(result.materials[0].name, "default");
  EXPECT_EQ(result.materials[1].name, "red paint");
  EXPECT_EQ(result.materials[1].diffuse, (Vec3{0.5f, 0.25f, 0}));
  EXPECT_EQ(result.materials[1].specular, (Vec3{1, 0, 0.125f}));
  EXPECT_EQ(result.materials[2].specular, Vec3{});
}

TEST(Obj, FrozenBadInputs) {
  const BadCase cases[] = {
      {"", "no faces"},
      {"v 0 0 0\n", "no faces"},
      {"v 0 0\n", "line 1: a coordinate is '', not a number"},
      {"v 0 0 nan\n", "line 1: vertex 0 has the coordinate nan"},
      {"v 0 0 1e39\n", "line 1: vertex 0 has the coordinate"},
      {"v 0 0 zero\n", "'zero', not a number"},
      {"v 0 0 0\nf 1 1 2\n", "line 2: the corner '2' is out of range; 1 vertices"},
      {"v 0 0 0\nf 1 1 0\n", "out of range"},
      {"v 0 0 0\nf 1 1 -2\n", "out of range"},
      {"v 0 0 0\nf 1 1 4294967297\n", "out of range"},
      {"v 0 0 0\nf 1 1 99999999999999999999999\n", "out of range"},
      {"v 0 0 0\nf 1 1 x\n", "does not start with an index"},
      {"v 0 0 0\nf 1 1 /1\n", "does not start with an index"},
      {"v 0 0 0\nf 1 1\n", "2 corners"},
      {"v 0 0 0\nf\n", "0 corners"},
  };
  for (const BadCase& bad : cases) {
    expect_refusal(bad, refusal([&] { irt::parse_obj(bad.text, no_library); }));
  }
}

TEST(Obj, PolygonsOfAMillionCornersAreFans) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int i = 0; i < 1'000'000; ++i) text += " 1";
  EXPECT_EQ(irt::parse_obj(text, no_library).mesh.triangles.size(), 999'998u);
}

TEST(Obj, LibrariesOfAMillionMaterialsAreRefused) {
  std::string text;
  for (int i = 0; i < 1'000'000; ++i) text += "newmtl a\n";
  EXPECT_NE(refusal([&] { irt::parse_mtl(text); }).find("65536 materials"), std::string::npos);
}

MeshWithMaterials one_triangle(std::string_view file) {
  EXPECT_EQ(file, "m.ply");
  return {{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}, {0}}, {irt::default_material()}};
}

TEST(SceneFile, EverythingItCanSay) {
  const Scene scene = irt::parse_scene(R"({
    // A comment.
    "meshes": ["m.ply", {"file": "m.ply", "material": "blue"}],
    "boxes": [{"lo": [5, 1, 1], "hi": [4, 0, 0], "material": "mirror"}],
    "materials": {"blue": {"diffuse": [0, 0, 1]}, "mirror": {"specular": [0.5, 0.5, 0.5]},
                  "default": {"diffuse": [1, 0, 0]}},
    "regions": [{"lo": [-1, -1, -1], "hi": [2, 2, 0], "material": "mirror"}],
    "lights": [{"position": [1, 2, 3]}, {"position": [3, 2, 1], "intensity": [2, 1, 0]}],
    "camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": [1, 0, 0], "vertical_fov": 30}})",
                                       one_triangle);
  ASSERT_EQ(scene.mesh.triangles.size(), 14u);
  EXPECT_EQ(scene.mesh.triangles[1], (TriangleIndices{3, 4, 5}));
  EXPECT_EQ(scene.materials[scene.mesh.material[0]].name, "mirror");
  EXPECT_EQ(scene.materials[scene.mesh.material[1]].name, "mirror");
  EXPECT_EQ(scene.materials[scene.mesh.material[13]].name, "mirror");
  EXPECT_EQ(irt::bounds_of(scene.mesh).hi, (Vec3{5, 2, 1}));
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[1].intensity, (Vec3{2, 1, 0}));
  EXPECT_EQ(scene.camera.up, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.camera.vertical_fov, 30);
}

TEST(SceneFile, WhatItLeavesOutIsDerived) {
  const Scene scene = irt::parse_scene(
      R"({"meshes": ["m.ply"], "materials": {"default": {"diffuse": [1, 0, 0]}}})", one_triangle);
  EXPECT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(scene.camera.target, (Vec3{1, 1, 0}));
  // A material of the mesh's own is replaced by the file's of the same name.
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].diffuse, (Vec3{1, 0, 0}));
}

TEST(SceneFile, FrozenBadInputs) {
  const std::string deep(100'000, '[');
  const BadCase cases[] = {
      {"", "no valid JSON"},
      {"{\n\n\"meshes\": [}", "line 3: is no valid JSON"},
      {deep.c_str(), "no valid JSON"},
      {"[]", "the file is to be an object"},
      {"{}", "no faces"},
      {R"({"mesh": []})", "has the key 'mesh'; it may have meshes, boxes"},
      {R"({"meshes": "m.ply"})", "meshes is to be a list"},
      {R"({"meshes": [3]})", "meshes[0] is to be an object"},
      {R"({"meshes": [{"material": "x"}]})", "meshes[0] lacks the key 'file'"},
      {R"({"meshes": [{"file": "m.ply", "material": "x"}]})", "'x', which 'materials' does not"},
      {R"({"boxes": [{"lo": [0,0,0], "hi": [1,1,1]}]})", "boxes[0] lacks the key 'material'"},
      {R"({"materials": []})", "materials is to be an object"},
      {R"({"materials": {"a": {"diffuse": [0, 0, 1.5]}}})",
       "materials.'a'.diffuse[2] is 1.5; it lies between 0 and 1"},
      {R"({"meshes": ["m.ply"], "lights": [{"position": [0, 0]}]})", "three numbers"},
      {R"({"meshes": ["m.ply"], "lights": [{"position": [0, 0, "1"]}]})", "is to be a number"},
      {R"({"meshes": ["m.ply"], "lights": [{"position": [0, 0, 1e30]}]})", "lies between"},
      {R"({"meshes": ["m.ply"], "camera": {"eye": [1, 1, 1], "target": [1, 1, 1]}})",
       "eye at its target"},
      {R"({"meshes": ["m.ply"], "camera": {"eye": [0, 1, 0], "target": [0, 0, 0]}})",
       "looks along its 'up'"},
      {R"({"meshes": ["m.ply"], "camera": {"eye": [0, 1, 2], "target": [0, 0, 0],
           "vertical_fov": 180}})",
       "camera.vertical_fov is 180"},
  };
  for (const BadCase& bad : cases) {
    expect_refusal(bad, refusal([&] { irt::parse_scene(bad.text, one_triangle); }));
  }
}

TEST(Quotes, ShowNamesAsTheyAreAndNothingThatControls) {
  EXPECT_EQ(irt::in_quotes("ünï/日本.ply"), "'ünï/日本.ply'");
  EXPECT_EQ(irt::in_quotes("a\xff\x01\x7f\n"), "'a\?\?\?\?'");
  EXPECT_EQ(irt::in_quotes("\xc2\x85"), "'\?\?'");        // a line end of its own
  EXPECT_EQ(irt::in_quotes("\xc0\xaf"), "'\?\?'");        // too long for what it says
  EXPECT_EQ(irt::in_quotes("\xed\xa0\x80"), "'\?\?\?'");  // half a pair
  EXPECT_EQ(irt::in_quotes("a\xe6\x97"), "'a\?\?'");      // torn
}

TEST(Quotes, CutWhatIsLongBeforeItsEnd) {
  const std::string fits = "/" + std::string(55, 'a') + ".ply";
  EXPECT_EQ(irt::in_quotes(fits), "'" + fits + "'");
  EXPECT_EQ(irt::in_quotes("/home" + std::string(100, 'x') + "/küche.ply"),
            "'/home" + std::string(15, 'x') + "..." + std::string(30, 'x') + "/küche.ply'");
}

}  // namespace
