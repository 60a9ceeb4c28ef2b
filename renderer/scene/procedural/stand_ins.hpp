/// Procedural scenes with the triangle counts of the thesis' three, for machines without the data.
///
/// Only +, -, *, / and square roots make them: these round the same everywhere, so a stand-in has
/// the same bits on every machine (floating-point contraction is off in the whole project).
#pragma once

#include "renderer/scene/scene.hpp"

namespace irt {

/// Triangles that each stand-in has, from the thesis' chapter 4.
inline constexpr std::size_t bunny_triangles = 69'463;
inline constexpr std::size_t office_triangles = 20'769;
inline constexpr std::size_t conference_triangles = 190'951;

/// An animal with long ears beside a mirror box, in the place and at the native scale (0.15 units)
/// of the Stanford bunny, so that an absolute epsilon breaks on it as on the real one. Triangles
/// [0, 69,450) are one closed surface. A closed surface has an even number of triangles and the
/// thesis' bunny 69,451 (it has holes), so triangle 69,450 repeats triangle 0. The box is the last
/// 12 triangles.
Scene make_bunny();

/// A room of 4.4 by 4.8 m with a desk, a bookcase, blinds and a plant.
Scene make_office();

/// A hall of 11 by 7 m: a table for 18 with what lies on it, blinds, curtains, lamps and plants.
Scene make_conference();

}  // namespace irt
