#include "renderer/shading/primary_rays.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/shading/primary_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Defined once, for the first target that sees it.
#ifndef IRT_TILE_PLACES
#define IRT_TILE_PLACES
namespace irt {

/// Column and row in a tile of each place on the curve.
struct TilePlaces {
  alignas(64) std::int32_t column[tile_side * tile_side];
  alignas(64) std::int32_t row[tile_side * tile_side];
};
inline constexpr TilePlaces tile_places = [] {
  TilePlaces places{};
  for (std::uint32_t morton = 0; morton < tile_side * tile_side; ++morton) {
    places.column[morton] = static_cast<std::int32_t>(even_bits(morton));
    places.row[morton] = static_cast<std::int32_t>(even_bits(morton >> 1));
  }
  return places;
}();

}  // namespace irt
#endif  // IRT_TILE_PLACES

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void add_run(const PrimaryRays::View& view, std::uint32_t left, std::uint32_t top,
             std::uint32_t first, std::uint32_t count, InPixel within, float weight, Rays& rays) {
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<std::int32_t, decltype(d)> integers;
  const auto all = [d](float value) { return hn::Set(d, value); };
  const auto number = [integers](std::uint32_t value) {
    return hn::Set(integers, static_cast<std::int32_t>(value));
  };
  // Bit by bit what `through` computes.
  const auto offset = [&](const auto& pixel, float in_pixel, float half) {
    return hn::Sub(hn::Mul(hn::Add(hn::ConvertTo(d, pixel), all(in_pixel)), all(view.step)),
                   all(half));
  };
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const auto x = hn::Add(number(left), hn::LoadU(integers, &tile_places.column[first + i]));
    const auto y = hn::Add(number(top), hn::LoadU(integers, &tile_places.row[first + i]));
    const auto across = offset(x, within.x, view.half_width);
    const auto down = offset(y, within.y, view.half_height);
    const auto along = [&](float forward, float right, float up) {
      return hn::Sub(hn::Add(all(forward), hn::Mul(all(right), across)), hn::Mul(all(up), down));
    };
    const std::uint32_t at = rays.size + i;
    hn::StoreU(all(view.eye.x), d, &rays.origin_x[at]);
    hn::StoreU(all(view.eye.y), d, &rays.origin_y[at]);
    hn::StoreU(all(view.eye.z), d, &rays.origin_z[at]);
    hn::StoreU(along(view.forward.x, view.right.x, view.up.x), d, &rays.direction_x[at]);
    hn::StoreU(along(view.forward.y, view.right.y, view.up.y), d, &rays.direction_y[at]);
    hn::StoreU(along(view.forward.z, view.right.z, view.up.z), d, &rays.direction_z[at]);
    hn::StoreU(all(Ray{}.t_max), d, &rays.t_max[at]);
    hn::StoreU(all(weight), d, &rays.weight_r[at]);
    hn::StoreU(all(weight), d, &rays.weight_g[at]);
    hn::StoreU(all(weight), d, &rays.weight_b[at]);
    const hn::Rebind<std::uint32_t, decltype(d)> pixels;
    const auto pixel = hn::Add(hn::Mul(y, number(view.width)), x);
    hn::StoreU(hn::BitCast(pixels, pixel), pixels, &rays.pixel[at]);
  }
  rays.size += count;
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(add_run);

void PrimaryRays::add_run(std::uint32_t left, std::uint32_t top, std::uint32_t first,
                          std::uint32_t count, InPixel within, float weight, Rays& rays) const {
  HWY_DYNAMIC_DISPATCH(add_run)(view_, left, top, first, count, within, weight, rays);
}

PrimaryRays::PrimaryRays(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  view_.eye = camera.eye;
  view_.forward = normalize(camera.target - camera.eye);
  view_.width = width;
  Vec3 sideways = cross(view_.forward, camera.up);
  if (!(length(sideways) > 0)) {  // looking along `up`: any other direction will do
    sideways =
        cross(view_.forward, std::abs(view_.forward.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
  }
  view_.right = normalize(sideways);
  view_.up = cross(view_.right, view_.forward);
  // The tangent may differ by a unit in the last place of a double between mathematical libraries;
  // rounded to a float it does not, but for one angle in some hundred millions.
  constexpr double radians_per_degree = 0.017453292519943295;
  view_.half_height = static_cast<float>(std::tan(0.5 * camera.vertical_fov * radians_per_degree));
  view_.half_width = view_.half_height * static_cast<float>(width) / static_cast<float>(height);
  view_.step = 2 * view_.half_height / static_cast<float>(height);
}

}  // namespace irt
#endif  // HWY_ONCE
