/// The rays that all contestants trace: those of one picture, kind by kind, in tasks of a tile.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/tracer/contestant.hpp"

namespace irt::tracer {

enum class RayKind { primary, shadow, specular };
std::string_view name_of(RayKind kind);

/// Pixels of a tile, in an order in which every aligned run of 4, 8 or 16 is a block.
inline constexpr std::uint32_t tile_side = 16;
inline constexpr std::uint32_t tile_rays = tile_side * tile_side;

/// Adds the primary rays of the tile at (left, top) of a picture of `side` x `side` pixels.
void add_tile(const Camera& camera, std::uint32_t side, std::uint32_t left, std::uint32_t top,
              Rays& rays);

/// Adds the shadow rays of the hits, from light `light` to the surface, or their mirrored rays: one
/// for every hit, whatever the material. The worst case, and the same number for everybody.
void add_shadow_rays(const Scene& scene, std::size_t light, const Rays& rays, const Hits& hits,
                     Rays& shadow);
void add_mirrored_rays(const Scene& scene, const Rays& rays, const Hits& hits, Rays& mirrored);

/// One batch per tile and, for shadow rays, per light. `guide` finds the hits they start from.
std::vector<Rays> rays_of(const Scene& scene, std::uint32_t side, RayKind kind,
                          const Contestant& guide);

}  // namespace irt::tracer
