#include "renderer/scene/procedural/furniture.hpp"
#include "renderer/scene/procedural/stand_ins.hpp"

namespace irt {
namespace {

constexpr float room_x = 4.4f;
constexpr float room_y = 2.8f;
constexpr float room_z = 4.8f;
constexpr float desk_y = 0.74f;

/// The indices of the room's materials.
struct Paints {
  explicit Paints(Scene& scene) : s(scene) {}
  Scene& s;
  std::uint32_t wall = add_material(s, "wall", {0.62f, 0.61f, 0.57f});
  std::uint32_t accent = add_material(s, "accent wall", {0.27f, 0.38f, 0.42f});
  std::uint32_t ceiling = add_material(s, "ceiling", {0.8f, 0.8f, 0.78f});
  std::uint32_t boards = add_material(s, "boards", {0.42f, 0.27f, 0.16f}, {0.07f, 0.06f, 0.05f});
  std::uint32_t rug = add_material(s, "rug", {0.4f, 0.13f, 0.1f});
  std::uint32_t rug_edge = add_material(s, "rug edge", {0.6f, 0.5f, 0.36f});
  std::uint32_t oak = add_material(s, "oak", {0.58f, 0.4f, 0.22f}, {0.05f, 0.05f, 0.05f});
  std::uint32_t walnut = add_material(s, "walnut", {0.28f, 0.17f, 0.1f}, {0.04f, 0.04f, 0.04f});
  std::uint32_t white = add_material(s, "white paint", {0.78f, 0.77f, 0.74f});
  std::uint32_t steel = add_material(s, "painted steel", {0.33f, 0.36f, 0.38f});
  std::uint32_t black = add_material(s, "black plastic", {0.06f, 0.06f, 0.065f});
  std::uint32_t grey = add_material(s, "grey plastic", {0.42f, 0.42f, 0.42f});
  std::uint32_t chrome = add_material(s, "chrome", {0.08f, 0.08f, 0.08f}, {0.72f, 0.72f, 0.73f});
  std::uint32_t brass = add_material(s, "brass", {0.12f, 0.08f, 0.03f}, {0.57f, 0.43f, 0.2f});
  std::uint32_t mirror = add_material(s, "mirror", {0.02f, 0.02f, 0.02f}, {0.88f, 0.89f, 0.9f});
  std::uint32_t pane = add_material(s, "pane", {0.3f, 0.42f, 0.55f}, {0.2f, 0.2f, 0.2f});
  std::uint32_t screen = add_material(s, "screen", {0.05f, 0.08f, 0.14f}, {0.16f, 0.16f, 0.16f});
  std::uint32_t cloth = add_material(s, "cloth", {0.12f, 0.2f, 0.34f});
  std::uint32_t ceramic = add_material(s, "ceramic", {0.7f, 0.24f, 0.12f}, {0.08f, 0.08f, 0.08f});
  std::uint32_t earth = add_material(s, "earth", {0.12f, 0.08f, 0.05f});
  std::uint32_t leaf = add_material(s, "leaf", {0.13f, 0.34f, 0.1f});
  std::uint32_t paper = add_material(s, "paper", {0.82f, 0.81f, 0.76f});
  std::uint32_t sketch = add_material(s, "picture", {0.5f, 0.55f, 0.45f});
  std::uint32_t books = add_material(s, "book, red", {0.46f, 0.1f, 0.09f});
  std::uint32_t last_book = add_books_but_first();

  std::uint32_t add_books_but_first() {
    add_material(s, "book, blue", {0.1f, 0.17f, 0.38f});
    add_material(s, "book, green", {0.13f, 0.3f, 0.2f});
    add_material(s, "book, ochre", {0.6f, 0.43f, 0.14f});
    add_material(s, "book, cream", {0.68f, 0.63f, 0.5f});
    return add_material(s, "book, black", {0.09f, 0.08f, 0.09f});
  }
  [[nodiscard]] int book_colours() const { return static_cast<int>(last_book - books) + 1; }
};

void add_shell(Mesh& mesh, const Paints& paint) {
  constexpr float x = room_x;
  constexpr float y = room_y;
  constexpr float z = room_z;
  add_patch(mesh, {0, 0, z}, {x, 0, z}, {x, 0, 0}, {0, 0, 0}, 1, 1, paint.boards);
  add_patch(mesh, {0, y, 0}, {x, y, 0}, {x, y, z}, {0, y, z}, 1, 1, paint.ceiling);
  add_patch(mesh, {0, 0, z}, {0, 0, 0}, {0, y, 0}, {0, y, z}, 1, 1, paint.wall);
  add_patch(mesh, {x, 0, 0}, {x, 0, z}, {x, y, z}, {x, y, 0}, 1, 1, paint.accent);
  add_patch(mesh, {x, 0, z}, {0, 0, z}, {0, y, z}, {x, y, z}, 1, 1, paint.wall);
  const Vec3 lo{1.7f, 0.95f, 0};
  const Vec3 hi{3.9f, 2.35f, 0};
  add_wall(mesh, x, y, lo, hi, paint.wall);
  add_patch(mesh, {lo.x, lo.y, -0.1f}, {hi.x, lo.y, -0.1f}, {hi.x, hi.y, -0.1f},
            {lo.x, hi.y, -0.1f}, 1, 1, paint.pane);
  add_box(mesh, {lo.x, lo.y - 0.04f, -0.1f}, {hi.x, lo.y, 0.12f}, paint.white);
  add_box(mesh, {lo.x, hi.y, -0.1f}, {hi.x, hi.y + 0.05f, 0.02f}, paint.white);
  for (const float at : {lo.x - 0.05f, 0.5f * (lo.x + hi.x) - 0.025f, hi.x}) {
    add_box(mesh, {at, lo.y, -0.1f}, {at + 0.05f, hi.y, 0.0f}, paint.white);
  }
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = mesh.vertices.size();
    add_blind(mesh, 1.06f, side == 0 ? 1.38f : 0.9f, side == 0 ? 46 : 30, 2, paint.white,
              paint.grey);
    place(mesh, first, 0, {side == 0 ? 1.71f : 2.83f, side == 0 ? 0.96f : 1.44f, 0.03f});
  }
  add_box(mesh, {0, 0, 0}, {x, 0.08f, 0.015f}, paint.white);
  add_box(mesh, {x - 0.015f, 0, 0}, {x, 0.08f, z}, paint.white);
  add_box(mesh, {0, 0, 0}, {0.015f, 0.08f, z}, paint.white);
  add_box(mesh, {1.1f, 0.001f, 1.5f}, {3.3f, 0.012f, 3.9f}, paint.rug_edge);
  add_box(mesh, {1.2f, 0.002f, 1.6f}, {3.2f, 0.014f, 3.8f}, paint.rug);
  for (int i = 0; i < 28; ++i) {
    const float at = 1.75f + 0.075f * static_cast<float>(i);
    add_box(mesh, {at, 0.15f, 0.03f}, {at + 0.05f, 0.68f, 0.11f}, paint.white);
  }
  // Two ceiling lights with louvres.
  for (const float at : {1.2f, 3.2f}) {
    add_box(mesh, {at - 0.16f, y - 0.07f, 1.6f}, {at + 0.16f, y - 0.02f, 2.9f}, paint.chrome);
    for (int i = 0; i < 24; ++i) {
      const float bar = 1.61f + 0.054f * static_cast<float>(i);
      add_box(mesh, {at - 0.15f, y - 0.1f, bar}, {at + 0.15f, y - 0.07f, bar + 0.006f},
              paint.white);
    }
  }
}

void add_drawers(Mesh& mesh, Vec3 lo, Vec3 hi, int drawers, std::uint32_t body,
                 std::uint32_t handle) {
  add_box(mesh, lo, {hi.x, hi.y, hi.z - 0.02f}, body);
  const float tall = (hi.y - lo.y) / static_cast<float>(drawers);
  for (int i = 0; i < drawers; ++i) {
    const float y = lo.y + tall * static_cast<float>(i);
    add_box(mesh, {lo.x + 0.005f, y + 0.005f, hi.z - 0.02f},
            {hi.x - 0.005f, y + tall - 0.005f, hi.z}, body);
    const float grip = y + 0.7f * tall;
    const float x = 0.5f * (lo.x + hi.x);
    const Vec3 path[] = {{x - 0.07f, grip, hi.z},
                         {x - 0.06f, grip, hi.z + 0.025f},
                         {x + 0.06f, grip, hi.z + 0.025f},
                         {x + 0.07f, grip, hi.z}};
    add_rod(mesh, path, 0.006f, 8, handle);
  }
}

void add_computer(Mesh& mesh, const Paints& paint) {
  const Ring foot[] = {{0, 0},         {0.12f, 0},      {0.12f, 0.01f},
                       {0.03f, 0.02f}, {0.022f, 0.13f}, {0, 0.13f}};
  add_turned(mesh, {0, 0, -0.1f}, foot, 32, paint.black);
  add_box(mesh, {-0.29f, 0.11f, -0.09f}, {0.29f, 0.48f, -0.06f}, paint.black);
  add_patch(mesh, {-0.275f, 0.125f, -0.0595f}, {0.275f, 0.125f, -0.0595f},
            {0.275f, 0.465f, -0.0595f}, {-0.275f, 0.465f, -0.0595f}, 1, 1, paint.screen);
  add_box(mesh, {-0.23f, 0.002f, 0.12f}, {0.23f, 0.016f, 0.29f}, paint.black);
  for (int row = 0; row < 6; ++row) {
    for (int key = 0; key < 17; ++key) {
      if (row == 0 && key >= 5 && key < 10) continue;
      const float x = -0.221f + 0.026f * static_cast<float>(key);
      const float z = 0.277f - 0.026f * static_cast<float>(row);
      add_box(mesh, {x, 0.016f, z - 0.011f}, {x + 0.022f, 0.024f, z + 0.011f}, paint.grey);
    }
  }
  add_box(mesh, {-0.089f, 0.016f, 0.266f}, {0.037f, 0.024f, 0.288f}, paint.grey);
  add_cushion(mesh, {0.3f, 0, 0.17f}, {0.36f, 0.035f, 0.28f}, 6, paint.grey);
}

void add_desk_lamp(Mesh& mesh, const Paints& paint) {
  const Ring foot[] = {{0, 0}, {0.09f, 0}, {0.09f, 0.015f}, {0.07f, 0.025f}, {0, 0.03f}};
  add_turned(mesh, {}, foot, 32, paint.brass);
  const Vec3 arm[] = {{0, 0.02f, 0},          {-0.02f, 0.2f, 0},     {-0.05f, 0.36f, 0.02f},
                      {-0.02f, 0.45f, 0.06f}, {0.06f, 0.49f, 0.12f}, {0.12f, 0.47f, 0.16f}};
  add_rod(mesh, arm, 0.009f, 10, paint.brass);
  const Ring shade[] = {{0.1f, -0.13f}, {0.085f, -0.06f}, {0.05f, 0}, {0.02f, 0.02f}, {0, 0.022f}};
  add_turned(mesh, {0.12f, 0.46f, 0.16f}, shade, 40, paint.brass);
  const Ring lining[] = {{0, 0.015f}, {0.045f, -0.005f}, {0.08f, -0.06f}, {0.099f, -0.13f}};
  add_turned(mesh, {0.12f, 0.46f, 0.16f}, lining, 40, paint.white);
  add_ball(mesh, {0.12f, 0.4f, 0.16f}, 0.03f, 12, 8, paint.paper);
}

void add_desk(Mesh& mesh, const Paints& paint, std::minstd_rand& random) {
  add_box(mesh, {2.0f, desk_y - 0.035f, 0.2f}, {4.35f, desk_y, 1.0f}, paint.oak);
  add_box(mesh, {3.75f, desk_y - 0.035f, 1.0f}, {4.35f, desk_y, 2.4f}, paint.oak);
  add_drawers(mesh, {2.05f, 0.06f, 0.25f}, {2.5f, desk_y - 0.035f, 0.96f}, 3, paint.oak,
              paint.chrome);
  for (const Vec3 leg : {Vec3{4.2f, 0, 0.3f}, {4.2f, 0, 2.3f}, {3.85f, 0, 2.3f}}) {
    const Vec3 path[] = {leg, leg + Vec3{0, desk_y - 0.03f, 0}};
    add_rod(mesh, path, 0.025f, 16, paint.chrome);
  }
  std::size_t first = mesh.vertices.size();
  add_computer(mesh, paint);
  place(mesh, first, 0, {3.15f, desk_y, 0.58f});
  first = mesh.vertices.size();
  add_desk_lamp(mesh, paint);
  place(mesh, first, 0, {2.3f, desk_y, 0.42f});
  first = mesh.vertices.size();
  add_mug(mesh, 24, paint.ceramic);
  place(mesh, first, 0.9, {2.66f, desk_y, 0.72f});
  first = mesh.vertices.size();
  add_mug(mesh, 24, paint.steel);
  place(mesh, first, 0.3, {3.75f, desk_y, 0.5f});
  for (int i = 0; i < 9; ++i) {
    first = mesh.vertices.size();
    const Vec3 foot{uniform(random, -0.018f, 0.018f), 0.012f, uniform(random, -0.018f, 0.018f)};
    const Vec3 pencil[] = {foot, foot * 1.6f + Vec3{0, uniform(random, 0.13f, 0.17f), 0}};
    add_rod(mesh, pencil, 0.0035f, 6, i % 2 == 0 ? paint.rug : paint.leaf);
    place(mesh, first, 0, {3.75f, desk_y, 0.5f});
  }
  for (int i = 0; i < 14; ++i) {
    first = mesh.vertices.size();
    const float y = 0.001f + 0.0012f * static_cast<float>(i);
    add_box(mesh, {-0.105f, y, -0.148f}, {0.105f, y + 0.0008f, 0.148f}, paint.paper);
    place(mesh, first, uniform(random, -0.02f, 0.05f), {4.0f, desk_y, 1.3f});
  }
  for (int i = 0; i < 5; ++i) {
    first = mesh.vertices.size();
    add_pen(mesh, 8, i % 2 == 0 ? paint.black : paint.books);
    const float turns = uniform(random);
    const float x = uniform(random, 3.85f, 4.2f);
    place(mesh, first, turns, {x, desk_y, 1.6f + 0.04f * static_cast<float>(i)});
  }
  first = mesh.vertices.size();
  add_books(mesh, 0.45f, 0.3f, paint.books, paint.book_colours(), random);
  place(mesh, first, -0.25, {4.19f, desk_y, 1.8f});
}

void add_bookcase(Mesh& mesh, const Paints& paint, std::minstd_rand& random) {
  constexpr float wide = 1.5f;
  constexpr float tall = 2.2f;
  constexpr int shelves = 6;
  const std::size_t first = mesh.vertices.size();
  for (const float x : {0.0f, 0.5f * wide - 0.0125f, wide - 0.025f}) {
    add_box(mesh, {x, 0, -0.3f}, {x + 0.025f, tall, 0.01f}, paint.walnut);
  }
  add_box(mesh, {0, 0, -0.31f}, {wide, tall, -0.3f}, paint.walnut);
  for (int i = 0; i <= shelves; ++i) {
    const float y = (tall - 0.025f) * static_cast<float>(i) / shelves;
    add_box(mesh, {0, y, -0.3f}, {wide, y + 0.025f, 0}, paint.walnut);
    if (i == shelves) break;
    for (const float x : {0.03f, 0.5f * wide + 0.015f}) {
      const std::size_t row = mesh.vertices.size();
      add_books(mesh, 0.5f * wide - 0.05f, 0.33f, paint.books, paint.book_colours(), random);
      place(mesh, row, 0, {x, y + 0.025f, -0.05f});
    }
  }
  place(mesh, first, 0, {0.1f, 0, 0.33f});
}

}  // namespace

Scene make_office() {
  Scene scene;
  scene.name = "office";
  const Paints paint(scene);
  Mesh& mesh = scene.mesh;
  std::minstd_rand random(7);
  add_shell(mesh, paint);
  add_desk(mesh, paint, random);
  add_bookcase(mesh, paint, random);

  std::size_t first = mesh.vertices.size();
  add_chair(mesh, 5, paint.cloth, paint.chrome, paint.black);
  place(mesh, first, 0.44, {2.95f, 0.014f, 1.55f});
  first = mesh.vertices.size();
  add_chair(mesh, 2, paint.cloth, paint.steel, paint.black);
  place(mesh, first, 0.2, {1.5f, 0.014f, 2.6f});

  const Ring vase[] = {{0, 0},          {0.06f, 0},      {0.1f, 0.07f},
                       {0.1f, 0.13f},   {0.045f, 0.22f}, {0.04f, 0.25f},
                       {0.055f, 0.28f}, {0.05f, 0.28f},  {0.035f, 0.25f}};
  add_turned(mesh, {4.1f, desk_y, 0.45f}, vase, 36, paint.brass);
  const Ring bin[] = {{0, 0},          {0.12f, 0},      {0.15f, 0.33f}, {0.155f, 0.335f},
                      {0.148f, 0.33f}, {0.118f, 0.01f}, {0, 0.01f}};
  add_turned(mesh, {1.8f, 0, 0.75f}, bin, 28, paint.steel);

  first = mesh.vertices.size();
  add_picture(mesh, 1.1f, 0.8f, paint.oak, paint.mirror);
  place(mesh, first, -0.25, {room_x - 0.001f, 1.3f, 1.1f});
  first = mesh.vertices.size();
  add_picture(mesh, 0.8f, 1.1f, paint.black, paint.sketch);
  place(mesh, first, 0.25, {0.001f, 1.2f, 2.6f});
  add_box(mesh, {room_x - 0.05f, 0, 3.3f}, {room_x - 0.001f, 2.05f, 4.2f}, paint.walnut);
  const Ring knob[] = {{0, 0},         {0.012f, 0.001f}, {0.012f, 0.04f},
                       {0.03f, 0.05f}, {0.03f, 0.065f},  {0, 0.075f}};
  add_turned(mesh, {room_x - 0.08f, 1.0f, 3.4f}, knob, 20, paint.brass);

  first = mesh.vertices.size();
  add_plant(mesh, 1.45f, office_triangles - mesh.triangles.size(), paint.ceramic, paint.earth,
            paint.leaf, random);
  place(mesh, first, 0, {0.5f, 0, 1.2f});

  scene.lights = {{{1.2f, 2.3f, 1.3f}, {0.34f, 0.33f, 0.3f}},
                  {{3.2f, 2.3f, 1.5f}, {0.34f, 0.33f, 0.3f}},
                  {{1.2f, 2.3f, 3.3f}, {0.24f, 0.24f, 0.24f}},
                  {{3.2f, 2.2f, 3.9f}, {0.24f, 0.25f, 0.28f}}};
  scene.camera = {{0.75f, 1.75f, 4.55f}, {2.45f, 0.85f, 1.0f}, {0, 1, 0}, 60};
  return scene;
}

}  // namespace irt
