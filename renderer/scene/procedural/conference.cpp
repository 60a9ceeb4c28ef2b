#include <cmath>

#include "renderer/scene/procedural/furniture.hpp"
#include "renderer/scene/procedural/stand_ins.hpp"

namespace irt {
namespace {

constexpr float room_x = 11;
constexpr float room_y = 3;
constexpr float room_z = 7;
constexpr Vec3 table_centre{5.6f, 0, 3.6f};
constexpr float table_y = 0.75f;
constexpr float half_length = 3.4f;

/// The indices of the room's materials.
struct Paints {
  explicit Paints(Scene& scene) : s(scene) {}
  Scene& s;
  std::uint32_t wall = add_material(s, "wall", {0.66f, 0.62f, 0.54f});
  std::uint32_t panel = add_material(s, "panel", {0.46f, 0.29f, 0.16f}, {0.05f, 0.05f, 0.05f});
  std::uint32_t ceiling = add_material(s, "ceiling tile", {0.74f, 0.73f, 0.7f});
  std::uint32_t bar = add_material(s, "ceiling bar", {0.5f, 0.5f, 0.49f});
  std::uint32_t carpet = add_material(s, "carpet", {0.2f, 0.24f, 0.31f});
  std::uint32_t border = add_material(s, "carpet border", {0.33f, 0.3f, 0.27f});
  std::uint32_t table = add_material(s, "table", {0.34f, 0.17f, 0.09f}, {0.2f, 0.19f, 0.18f});
  std::uint32_t inlay = add_material(s, "table inlay", {0.1f, 0.09f, 0.08f}, {0.12f, 0.12f, 0.12f});
  std::uint32_t cloth = add_material(s, "cloth", {0.42f, 0.12f, 0.1f});
  std::uint32_t black = add_material(s, "black plastic", {0.07f, 0.07f, 0.075f});
  std::uint32_t chrome = add_material(s, "chrome", {0.09f, 0.09f, 0.09f}, {0.7f, 0.7f, 0.71f});
  std::uint32_t white = add_material(s, "white paint", {0.78f, 0.77f, 0.75f});
  std::uint32_t pane = add_material(s, "pane", {0.24f, 0.36f, 0.5f}, {0.22f, 0.22f, 0.22f});
  std::uint32_t glass = add_material(s, "glass", {0.3f, 0.34f, 0.34f}, {0.3f, 0.3f, 0.3f});
  std::uint32_t paper = add_material(s, "paper", {0.82f, 0.81f, 0.76f});
  std::uint32_t curtain = add_material(s, "curtain", {0.5f, 0.44f, 0.32f});
  std::uint32_t ceramic = add_material(s, "ceramic", {0.62f, 0.6f, 0.56f}, {0.06f, 0.06f, 0.06f});
  std::uint32_t earth = add_material(s, "earth", {0.12f, 0.08f, 0.05f});
  std::uint32_t leaf = add_material(s, "leaf", {0.12f, 0.32f, 0.11f});
  std::uint32_t sketch = add_material(s, "picture", {0.55f, 0.4f, 0.25f});
  std::uint32_t books = add_material(s, "book, red", {0.44f, 0.1f, 0.08f});
  std::uint32_t other_books = add_material(s, "book, blue", {0.1f, 0.17f, 0.37f});
  std::uint32_t last_books = add_material(s, "book, cream", {0.66f, 0.61f, 0.49f});
};

/// Half the table's width at `x` from its middle: it is wider there, like a boat.
float half_width(float x) {
  const float part = x / half_length;
  return 0.95f - 0.28f * part * part;
}

void add_table(Mesh& mesh, const Paints& paint) {
  const std::size_t first = mesh.vertices.size();
  // Top, rounded edge and underside: the outline shrunk by each step of the edge.
  constexpr int columns = 64;
  struct Step {
    float inset, y;
  };
  constexpr Step edge[] = {{0.25f, table_y - 0.05f},   {0.03f, table_y - 0.045f},
                           {0.006f, table_y - 0.035f}, {0, table_y - 0.02f},
                           {0.006f, table_y - 0.006f}, {0.02f, table_y}};
  const auto outline = [](const Step& step, int i, float side) {
    const float x = half_length * (2 * static_cast<float>(i) / columns - 1);
    const float shrink = 1 - step.inset / half_length;
    return Vec3{x * shrink, step.y, side * (half_width(x) - step.inset)};
  };
  for (const float side : {-1.0f, 1.0f}) {
    for (std::size_t k = 0; k + 1 < std::size(edge); ++k) {
      for (int i = 0; i < columns; ++i) {
        const int from = side > 0 ? i : i + 1;
        const int to = side > 0 ? i + 1 : i;
        add_patch(mesh, outline(edge[k], from, side), outline(edge[k], to, side),
                  outline(edge[k + 1], to, side), outline(edge[k + 1], from, side), 1, 1,
                  paint.table);
      }
    }
  }
  for (const int end : {0, columns}) {
    const float left = end == 0 ? -1.0f : 1.0f;
    for (std::size_t k = 0; k + 1 < std::size(edge); ++k) {
      add_patch(mesh, outline(edge[k], end, left), outline(edge[k], end, -left),
                outline(edge[k + 1], end, -left), outline(edge[k + 1], end, left), 8, 1,
                paint.table);
    }
  }
  for (int i = 0; i < columns; ++i) {
    const Step& top = edge[std::size(edge) - 1];
    add_patch(mesh, outline(top, i, 1), outline(top, i + 1, 1), outline(top, i + 1, -1),
              outline(top, i, -1), 1, 1, paint.table);
  }
  add_box(mesh, {-1.6f, table_y, -0.12f}, {1.6f, table_y + 0.003f, 0.12f}, paint.inlay);
  for (const float x : {-2.2f, 0.0f, 2.2f}) {
    add_box(mesh, {x - 0.35f, 0.08f, -0.3f}, {x + 0.35f, table_y - 0.05f, 0.3f}, paint.panel);
    add_box(mesh, {x - 0.4f, 0, -0.35f}, {x + 0.4f, 0.08f, 0.35f}, paint.black);
  }
  place(mesh, first, 0, table_centre);
}

/// A microphone on a swan's neck, leaning towards +z.
void add_microphone(Mesh& mesh, const Paints& paint) {
  const Ring foot[] = {{0, 0}, {0.05f, 0}, {0.05f, 0.012f}, {0.035f, 0.024f}, {0, 0.026f}};
  add_turned(mesh, {}, foot, 24, paint.black);
  std::vector<Vec3> neck;
  for (int i = 0; i <= 16; ++i) {
    const float t = static_cast<float>(i) / 16;
    neck.push_back({0, 0.02f + 0.3f * t - 0.06f * t * t, 0.16f * t * t});
  }
  add_rod(mesh, neck, 0.0035f, 8, paint.chrome);
  add_ball(mesh, neck.back(), 0.013f, 12, 8, paint.black);
}

/// What lies before one guest, who sits at +z.
void add_place(Mesh& mesh, const Paints& paint, std::minstd_rand& random) {
  std::size_t first = mesh.vertices.size();
  for (int i = 0; i < 6; ++i) {
    const float y = 0.001f + 0.0015f * static_cast<float>(i);
    add_box(mesh, {-0.11f, y, -0.15f}, {0.11f, y + 0.001f, 0.15f}, paint.paper);
  }
  place(mesh, first, uniform(random, -0.04f, 0.04f), {0, 0, 0.02f});
  first = mesh.vertices.size();
  add_pen(mesh, 12, uniform(random) < 0.5f ? paint.black : paint.chrome);
  const float pen_turns = uniform(random, 0.15f, 0.35f);
  place(mesh, first, pen_turns, {0.16f, 0, uniform(random, -0.02f, 0.06f)});
  first = mesh.vertices.size();
  add_glass(mesh, 20, paint.glass);
  place(mesh, first, 0, {0.2f, 0, -0.16f + uniform(random, -0.03f, 0.03f)});
  first = mesh.vertices.size();
  add_microphone(mesh, paint);
  place(mesh, first, 0, {-0.14f, 0, -0.25f});
}

void add_guests(Mesh& mesh, const Paints& paint, std::minstd_rand& random) {
  const auto seat = [&](Vec3 from_centre, double turns, float reach) {
    const Turn turn(turns);
    const Vec3 outwards{turn.sin, 0, turn.cos};
    std::size_t first = mesh.vertices.size();
    add_chair(mesh, 8, paint.cloth, paint.chrome, paint.black);
    const float askew = uniform(random, -0.05f, 0.05f);
    const float away = uniform(random, 0.28f, 0.42f);
    place(mesh, first, turns + 0.5 + askew, table_centre + from_centre + outwards * (reach + away));
    first = mesh.vertices.size();
    add_place(mesh, paint, random);
    place(mesh, first, turns,
          table_centre + from_centre + outwards * (reach - 0.28f) + Vec3{0, table_y, 0});
  };
  for (int i = 0; i < 8; ++i) {
    const float x = -2.8f + 0.8f * static_cast<float>(i);
    seat({x, 0, 0}, 0, half_width(x));
    seat({x, 0, 0}, 0.5, half_width(x));
  }
  seat({}, 0.25, half_length);
  seat({}, 0.75, half_length);
}

/// The window wall, along x at z = 0: blinds, sills and curtains.
void add_windows(Mesh& mesh, const Paints& paint) {
  constexpr float bottom = 0.85f;
  constexpr float top = 2.45f;
  for (int i = 0; i < 4; ++i) {
    const float x = 0.35f + 2.7f * static_cast<float>(i);
    std::size_t first = mesh.vertices.size();
    const float left = i == 0 ? 0.35f : 0.0f;
    add_wall(mesh, i == 3 ? room_x - x : 2.7f + left, room_y, {left + 0.3f, bottom, 0},
             {left + 2.2f, top, 0}, paint.wall);
    place(mesh, first, 0, {x - left, 0, 0});
    add_patch(mesh, {x + 0.3f, bottom, -0.12f}, {x + 2.2f, bottom, -0.12f}, {x + 2.2f, top, -0.12f},
              {x + 0.3f, top, -0.12f}, 1, 1, paint.pane);
    add_box(mesh, {x + 0.25f, bottom - 0.04f, -0.12f}, {x + 2.25f, bottom, 0.14f}, paint.white);
    add_box(mesh, {x + 0.25f, top, -0.12f}, {x + 2.25f, top + 0.05f, 0.01f}, paint.white);
    add_box(mesh, {x + 0.25f, bottom, -0.12f}, {x + 0.3f, top, 0.01f}, paint.white);
    add_box(mesh, {x + 2.2f, bottom, -0.12f}, {x + 2.25f, top, 0.01f}, paint.white);
    add_box(mesh, {x + 1.22f, bottom, -0.11f}, {x + 1.28f, top, -0.05f}, paint.white);
    first = mesh.vertices.size();
    const bool lowered = i % 2 == 0;
    add_blind(mesh, 1.88f, lowered ? 1.58f : 0.8f, lowered ? 52 : 26, 8, paint.white, paint.bar);
    place(mesh, first, 0, {x + 0.31f, lowered ? bottom + 0.01f : bottom + 0.79f, 0.03f});
  }
  for (const float x : {0.1f, 2.72f, 5.42f, 8.12f, 10.6f}) {
    constexpr int folds = 96;
    const auto at = [x](int i, float y) {
      const Turn wave(i / 12.0);
      return Vec3{x + 0.38f * static_cast<float>(i) / folds, y, 0.16f + 0.035f * wave.sin};
    };
    for (int i = 0; i < folds; ++i) {
      add_patch(mesh, at(i, 0.05f), at(i + 1, 0.05f), at(i + 1, 2.7f), at(i, 2.7f), 1, 12,
                paint.curtain);
    }
  }
  const Vec3 rail[] = {{0.05f, 2.72f, 0.16f}, {room_x - 0.05f, 2.72f, 0.16f}};
  add_rod(mesh, rail, 0.015f, 12, paint.chrome);
}

/// Ceiling bars, lights sunk into it, air vents, and lamps over the table.
void add_ceiling(Mesh& mesh, const Paints& paint) {
  add_patch(mesh, {0, room_y, 0}, {room_x, room_y, 0}, {room_x, room_y, room_z},
            {0, room_y, room_z}, 1, 1, paint.ceiling);
  for (int i = 1; i < 18; ++i) {
    const float x = room_x * static_cast<float>(i) / 18;
    add_box(mesh, {x - 0.012f, room_y - 0.012f, 0}, {x + 0.012f, room_y, room_z}, paint.bar);
  }
  for (int i = 1; i < 12; ++i) {
    const float z = room_z * static_cast<float>(i) / 12;
    add_box(mesh, {0, room_y - 0.011f, z - 0.012f}, {room_x, room_y, z + 0.012f}, paint.bar);
  }
  const Ring spot[] = {{0.05f, -0.004f}, {0.055f, -0.02f},  {0.09f, -0.035f},
                       {0.1f, -0.03f},   {0.105f, -0.015f}, {0.1f, 0}};
  for (int i = 0; i < 8; ++i) {
    for (const float z : {0.9f, 6.1f}) {
      const float x = 0.92f + 1.31f * static_cast<float>(i);
      add_turned(mesh, {x, room_y, z}, spot, 32, paint.chrome);
      add_ball(mesh, {x, room_y - 0.01f, z}, 0.05f, 16, 8, paint.white);
    }
  }
  for (const float x : {1.5f, 5.5f, 9.5f}) {
    for (const float z : {1.8f, 5.4f}) {
      add_box(mesh, {x - 0.28f, room_y - 0.03f, z - 0.28f}, {x + 0.28f, room_y - 0.01f, z + 0.28f},
              paint.black);
      for (int i = 0; i < 28; ++i) {
        const float at = x - 0.27f + 0.0195f * static_cast<float>(i);
        add_box(mesh, {at, room_y - 0.05f, z - 0.28f}, {at + 0.006f, room_y - 0.03f, z + 0.28f},
                paint.bar);
      }
    }
  }
  const Ring shade[] = {{0.24f, 0},     {0.235f, 0.05f}, {0.2f, 0.12f}, {0.13f, 0.18f},
                        {0.06f, 0.21f}, {0.03f, 0.25f},  {0.03f, 0.3f}, {0, 0.31f}};
  const Ring lining[] = {{0, 0.19f}, {0.12f, 0.17f}, {0.19f, 0.115f}, {0.23f, 0.045f}, {0.239f, 0}};
  for (const float x : {-2.2f, -0.75f, 0.75f, 2.2f}) {
    const Vec3 at = table_centre + Vec3{x, 1.95f, 0};
    add_turned(mesh, at, shade, 48, paint.chrome);
    add_turned(mesh, at, lining, 48, paint.white);
    add_ball(mesh, at + Vec3{0, 0.1f, 0}, 0.05f, 16, 10, paint.paper);
    const Vec3 flex[] = {at + Vec3{0, 0.3f, 0}, {at.x, room_y, at.z}};
    add_rod(mesh, flex, 0.004f, 8, paint.black);
  }
}

/// The other walls: wood panels around a screen, a sideboard, pictures and a door.
void add_walls(Mesh& mesh, const Paints& paint, std::minstd_rand& random) {
  constexpr float x = room_x;
  constexpr float y = room_y;
  constexpr float z = room_z;
  add_patch(mesh, {0, 0, z}, {x, 0, z}, {x, 0, 0}, {0, 0, 0}, 1, 1, paint.border);
  add_box(mesh, {0.7f, 0, 0.7f}, {x - 0.7f, 0.006f, z - 0.7f}, paint.carpet);
  add_patch(mesh, {0, 0, z}, {0, 0, 0}, {0, y, 0}, {0, y, z}, 1, 1, paint.wall);
  add_patch(mesh, {x, 0, 0}, {x, 0, z}, {x, y, z}, {x, y, 0}, 1, 1, paint.wall);
  add_patch(mesh, {x, 0, z}, {0, 0, z}, {0, y, z}, {x, y, z}, 1, 1, paint.wall);
  for (int i = 0; i < 100; ++i) {
    const float at = 0.02f + 0.07f * static_cast<float>(i);
    const bool behind_screen = at > 1.9f && at < 5.1f;
    add_box(mesh, {x - 0.04f, 0.1f, at}, {x, behind_screen ? 1.0f : 2.8f, at + 0.05f}, paint.panel);
  }
  std::size_t first = mesh.vertices.size();
  add_picture(mesh, 3.2f, 1.75f, paint.black, paint.white);
  place(mesh, first, -0.25, {x, 1.02f, 1.95f});

  const float side = z - 0.45f;
  add_box(mesh, {2.2f, 0.08f, side}, {7.8f, 0.11f, z}, paint.panel);
  add_box(mesh, {2.2f, 0.86f, side - 0.02f}, {7.8f, 0.9f, z}, paint.panel);
  for (int i = 0; i <= 7; ++i) {
    const float at = 2.2f + 0.8f * static_cast<float>(i);
    add_box(mesh, {at - 0.0125f, 0.11f, side}, {at + 0.0125f, 0.86f, z}, paint.panel);
    if (i == 7) break;
    for (const float shelf : {0.11f, 0.49f}) {
      first = mesh.vertices.size();
      add_books(mesh, 0.74f, 0.34f, paint.books, 3, random);
      place(mesh, first, 0.5, {at + 0.77f, shelf, side + 0.03f});
    }
  }
  for (const float at : {2.6f, 4.4f, 6.2f}) {
    first = mesh.vertices.size();
    add_picture(mesh, 1.2f, 0.9f, paint.black, paint.sketch);
    place(mesh, first, 0.5, {at + 1.2f, 1.45f, z});
  }
  add_box(mesh, {9.2f, 0, z - 0.04f}, {10.1f, 2.1f, z}, paint.panel);
  const Vec3 handle[] = {{9.3f, 1, z - 0.04f}, {9.3f, 1, z - 0.1f}, {9.42f, 1, z - 0.1f}};
  add_rod(mesh, handle, 0.01f, 16, paint.chrome);
}

}  // namespace

Scene make_conference() {
  Scene scene;
  scene.name = "conference";
  const Paints paint(scene);
  Mesh& mesh = scene.mesh;
  std::minstd_rand random(11);
  add_walls(mesh, paint, random);
  add_windows(mesh, paint);
  add_ceiling(mesh, paint);
  add_table(mesh, paint);
  add_guests(mesh, paint, random);
  const Vec3 corners[] = {{10.3f, 0, 0.75f}, {10.3f, 0, 6.3f}, {0.7f, 0, 0.85f}, {8.6f, 0, 6.3f}};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t missing = conference_triangles - mesh.triangles.size();
    const std::size_t first = mesh.vertices.size();
    add_plant(mesh, 1.7f, missing / (4 - i), paint.ceramic, paint.earth, paint.leaf, random);
    place(mesh, first, 0, corners[i]);
  }
  scene.lights = {{{2.8f, 2.25f, 1.9f}, {0.32f, 0.31f, 0.29f}},
                  {{8.4f, 2.25f, 1.9f}, {0.32f, 0.31f, 0.29f}},
                  {{2.8f, 2.25f, 5.3f}, {0.28f, 0.28f, 0.27f}},
                  {{8.4f, 2.25f, 5.3f}, {0.28f, 0.28f, 0.27f}}};
  scene.camera = {{0.9f, 2.05f, 6.3f}, {6.0f, 0.75f, 2.9f}, {0, 1, 0}, 60};
  return scene;
}

}  // namespace irt
