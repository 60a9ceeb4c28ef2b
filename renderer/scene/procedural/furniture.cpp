#include "renderer/scene/procedural/furniture.hpp"

#include <algorithm>
#include <utility>

namespace irt {

float uniform(std::minstd_rand& random) {
  return static_cast<float>(random() >> 7 & 0xffffff) * (1.0f / 16'777'216.0f);
}

float uniform(std::minstd_rand& random, float lo, float hi) {
  return lo + (hi - lo) * uniform(random);
}

std::uint32_t add_material(Scene& scene, std::string name, Vec3 diffuse, Vec3 specular) {
  scene.materials.push_back({std::move(name), diffuse, specular});
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_wall(Mesh& mesh, float width, float height, Vec3 opening_lo, Vec3 opening_hi,
              std::uint32_t material) {
  const auto rectangle = [&](float x0, float y0, float x1, float y1) {
    add_patch(mesh, {x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}, 1, 1, material);
  };
  rectangle(0, 0, width, opening_lo.y);
  rectangle(0, opening_hi.y, width, height);
  rectangle(0, opening_lo.y, opening_lo.x, opening_hi.y);
  rectangle(opening_hi.x, opening_lo.y, width, opening_hi.y);
}

void add_chair(Mesh& mesh, int detail, std::uint32_t cloth, std::uint32_t metal,
               std::uint32_t plastic) {
  const int sides = 4 + detail;
  const int n = 2 + detail;
  for (int leg = 0; leg < 5; ++leg) {
    const std::size_t first = mesh.vertices.size();
    const Vec3 spoke[] = {
        {0, 0.13f, 0.02f}, {0, 0.11f, 0.12f}, {0, 0.085f, 0.26f}, {0, 0.07f, 0.3f}};
    add_rod(mesh, spoke, 0.018f, sides, metal);
    for (const float x : {-0.018f, 0.018f}) {
      add_ball(mesh, {x, 0.032f, 0.3f}, 0.032f, sides, 2 + detail / 2, plastic);
    }
    place(mesh, first, leg / 5.0, {});
  }
  const Ring column[] = {{0, 0.09f},      {0.035f, 0.09f}, {0.035f, 0.16f}, {0.028f, 0.17f},
                         {0.028f, 0.33f}, {0.02f, 0.34f},  {0.02f, 0.42f},  {0.12f, 0.425f},
                         {0.12f, 0.44f},  {0, 0.44f}};
  add_turned(mesh, {}, column, 2 * sides, metal);
  add_cushion(mesh, {-0.25f, 0.43f, -0.24f}, {0.25f, 0.53f, 0.25f}, n + 1, cloth);

  // The back leans away and curves around the sitter.
  const auto back = static_cast<std::size_t>(mesh.vertices.size());
  add_cushion(mesh, {-0.24f, 0.58f, -0.045f}, {0.24f, 1.08f, 0.045f}, n + 2, cloth);
  for (std::size_t i = back; i < mesh.vertices.size(); ++i) {
    Vec3& p = mesh.vertices[i];
    const float lean = p.y - 0.58f;
    p.z += -0.24f + 1.1f * p.x * p.x - 0.12f * lean - 0.2f * lean * lean;
  }
  const Vec3 spine[] = {{0, 0.42f, -0.05f},
                        {0, 0.43f, -0.2f},
                        {0, 0.46f, -0.27f},
                        {0, 0.55f, -0.3f},
                        {0, 0.8f, -0.33f}};
  add_rod(mesh, spine, 0.022f, sides, metal);
  for (const float x : {-0.27f, 0.27f}) {
    const Vec3 arm[] = {{x * 0.6f, 0.44f, 0},
                        {x * 0.95f, 0.45f, 0},
                        {x, 0.48f, 0},
                        {x, 0.6f, -0.01f},
                        {x, 0.66f, -0.02f}};
    add_rod(mesh, arm, 0.014f, sides, metal);
    add_cushion(mesh, {x - 0.035f, 0.65f, -0.15f}, {x + 0.035f, 0.69f, 0.13f}, std::max(2, n - 3),
                plastic);
  }
}

void add_books(Mesh& mesh, float width, float height, std::uint32_t first_colour, int colours,
               std::minstd_rand& random) {
  for (float x = 0;;) {
    const float thick = uniform(random, 0.014f, 0.05f);
    if (x + thick > width) return;
    const float tall = height * uniform(random, 0.68f, 0.97f);
    const float deep = uniform(random, 0.13f, 0.2f);
    const auto colour = static_cast<std::uint32_t>(uniform(random) * static_cast<float>(colours));
    add_box(mesh, {x, 0, -deep}, {x + thick - 0.0015f, tall, 0}, first_colour + colour);
    x += thick;
    if (uniform(random) < 0.06f) x += uniform(random, 0.02f, 0.12f);
  }
}

void add_blind(Mesh& mesh, float width, float height, int slats, int cells_along,
               std::uint32_t slat, std::uint32_t cord) {
  add_box(mesh, {0, height - 0.03f, -0.02f}, {width, height, 0.02f}, slat);
  const float pitch = (height - 0.05f) / static_cast<float>(slats);
  for (int i = 0; i < slats; ++i) {
    // Half open, its cross-section an arc of three chords.
    const float y = height - 0.04f - pitch * (static_cast<float>(i) + 0.5f);
    const Vec3 arc[] = {{0, y - 0.011f, 0.012f},
                        {0, y - 0.001f, 0.006f},
                        {0, y + 0.007f, -0.003f},
                        {0, y + 0.011f, -0.013f}};
    for (int k = 0; k < 3; ++k) {
      const Vec3 across{width, 0, 0};
      add_patch(mesh, arc[k], arc[k] + across, arc[k + 1] + across, arc[k + 1], cells_along, 1,
                slat);
    }
  }
  for (const float part : {0.1f, 0.5f, 0.9f}) {
    const Vec3 path[] = {{part * width, 0.01f, 0}, {part * width, height, 0}};
    add_rod(mesh, path, 0.0012f, 4, cord);
  }
  add_box(mesh, {0, 0, -0.013f}, {width, 0.015f, 0.013f}, slat);
}

void add_plant(Mesh& mesh, float height, std::size_t triangles, std::uint32_t pot,
               std::uint32_t earth, std::uint32_t leaf, std::minstd_rand& random) {
  const std::size_t end = mesh.triangles.size() + triangles;
  const float r = 0.14f * height;
  const Ring outside[] = {
      {0, 0},     {r * 0.8f, 0},        {r, 1.7f * r}, {1.1f * r, 1.7f * r}, {1.1f * r, 2 * r},
      {r, 2 * r}, {0.95f * r, 1.7f * r}};
  add_turned(mesh, {}, outside, 24, pot);
  const Ring inside[] = {{0.96f * r, 1.75f * r}, {0, 1.8f * r}};
  add_turned(mesh, {}, inside, 24, earth);
  constexpr std::size_t per_leaf = 8;
  while (mesh.triangles.size() < end) {
    const Turn turn(uniform(random));
    const Vec3 out{turn.cos, 0, turn.sin};
    const float reach = uniform(random, 0.08f, 0.34f) * height;
    const float top = height * uniform(random, 0.35f, 1.0f);
    const Vec3 root = out * (0.4f * r * uniform(random)) + Vec3{0, 1.75f * r, 0};
    const Vec3 middle = out * (0.45f * reach) + Vec3{0, 1.1f * top, 0};
    const Vec3 tip = out * reach + Vec3{0, top - 0.3f * reach, 0};
    const std::size_t missing = end - mesh.triangles.size();
    add_leaf(mesh, root, middle, tip, 0.016f * height,
             static_cast<int>(std::min(per_leaf, missing)), leaf);
  }
}

void add_mug(Mesh& mesh, int segments, std::uint32_t material) {
  const Ring profile[] = {{0, 0},           {0.036f, 0},     {0.04f, 0.004f},  {0.041f, 0.09f},
                          {0.039f, 0.092f}, {0.037f, 0.09f}, {0.036f, 0.008f}, {0, 0.006f}};
  add_turned(mesh, {}, profile, segments, material);
  const Vec3 handle[] = {{0.038f, 0.078f, 0}, {0.056f, 0.076f, 0}, {0.066f, 0.062f, 0},
                         {0.066f, 0.042f, 0}, {0.056f, 0.024f, 0}, {0.038f, 0.02f, 0}};
  add_rod(mesh, handle, 0.005f, std::max(4, segments / 3), material);
}

void add_glass(Mesh& mesh, int segments, std::uint32_t material) {
  const Ring profile[] = {{0, 0},           {0.028f, 0},       {0.03f, 0.003f},  {0.034f, 0.06f},
                          {0.037f, 0.12f},  {0.036f, 0.1215f}, {0.0345f, 0.12f}, {0.0315f, 0.06f},
                          {0.028f, 0.012f}, {0, 0.01f}};
  add_turned(mesh, {}, profile, segments, material);
}

void add_pen(Mesh& mesh, int sides, std::uint32_t material) {
  const Vec3 barrel[] = {{-0.07f, 0.005f, 0}, {0.055f, 0.005f, 0}};
  add_rod(mesh, barrel, 0.005f, sides, material);
  const Vec3 point[] = {{0.055f, 0.005f, 0}, {0.07f, 0.005f, 0}};
  add_rod(mesh, point, 0.002f, sides, material);
}

void add_picture(Mesh& mesh, float width, float height, std::uint32_t frame,
                 std::uint32_t picture) {
  constexpr float bar = 0.035f;
  constexpr float deep = 0.025f;
  add_patch(mesh, {bar, bar, 0.01f}, {width - bar, bar, 0.01f}, {width - bar, height - bar, 0.01f},
            {bar, height - bar, 0.01f}, 1, 1, picture);
  add_box(mesh, {0, 0, 0}, {width, bar, deep}, frame);
  add_box(mesh, {0, height - bar, 0}, {width, height, deep}, frame);
  add_box(mesh, {0, bar, 0}, {bar, height - bar, deep}, frame);
  add_box(mesh, {width - bar, bar, 0}, {width, height - bar, deep}, frame);
}

}  // namespace irt
