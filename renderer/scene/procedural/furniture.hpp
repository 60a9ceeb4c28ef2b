/// What the procedural rooms are furnished with, in metres, standing on y = 0 around the origin and
/// facing +z unless said otherwise.
#pragma once

#include <random>

#include "renderer/scene/procedural/shapes.hpp"

namespace irt {

/// A number in [0, 1), the same on every machine: the standard fixes this generator's sequence.
/// Draw one number per statement: in which order a call's arguments are evaluated is not fixed.
float uniform(std::minstd_rand& random);

/// A number in [lo, hi).
float uniform(std::minstd_rand& random, float lo, float hi);

/// Appends a material and returns its index.
std::uint32_t add_material(Scene& scene, std::string name, Vec3 diffuse, Vec3 specular = {});

/// A wall in the plane z = 0 from the origin to (width, height), front to +z, around an opening.
void add_wall(Mesh& mesh, float width, float height, Vec3 opening_lo, Vec3 opening_hi,
              std::uint32_t material);

/// A swivel chair on five castors: about 500 * detail triangles, for 1 <= detail <= 8.
void add_chair(Mesh& mesh, int detail, std::uint32_t cloth, std::uint32_t metal,
               std::uint32_t plastic);

/// A row of books along x from 0 to `width`, backs to +z, no higher than `height`, in one of the
/// `colours` materials from `first_colour` on: 12 triangles each.
void add_books(Mesh& mesh, float width, float height, std::uint32_t first_colour, int colours,
               std::minstd_rand& random);

/// A Venetian blind in the plane z = 0, hanging from `height` to y = 0, x from 0 to `width`.
void add_blind(Mesh& mesh, float width, float height, int slats, int cells_along,
               std::uint32_t slat, std::uint32_t cord);

/// A plant in a pot, `height` high: exactly `triangles`, of which the pot has 288.
void add_plant(Mesh& mesh, float height, std::size_t triangles, std::uint32_t pot,
               std::uint32_t earth, std::uint32_t leaf, std::minstd_rand& random);

/// A mug, its handle towards +x.
void add_mug(Mesh& mesh, int segments, std::uint32_t material);

/// A drinking glass.
void add_glass(Mesh& mesh, int segments, std::uint32_t material);

/// A pen of 14 cm along x, its middle over the origin.
void add_pen(Mesh& mesh, int sides, std::uint32_t material);

/// A frame around a picture of `width` x `height` in the plane z = 0, its lower left corner at the
/// origin.
void add_picture(Mesh& mesh, float width, float height, std::uint32_t frame, std::uint32_t picture);

}  // namespace irt
