/// What the scalar structures share: a ray with its kernel's numbers, and the loop over a batch.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/ray_loop.hpp"
#include "renderer/tracing/intersection.hpp"
#include "renderer/tracing/kernels-inl.hpp"

namespace irt {

namespace scalar = HWY_NAMESPACE;

inline scalar::VecOf<float> vec_of(Vec3 a) {
  return {a.x, a.y, a.z};
}

/// A ray as the traversal and as `Kernel` want it.
template <class Kernel>
struct KernelRay : TraversalRay {
  typename Kernel::template Line<float> line;

  explicit KernelRay(const Ray& ray)
      : TraversalRay(ray),
        line(Kernel::template prepare<float>(
            scalar::LineOf<float>{vec_of(ray.origin), vec_of(ray.direction), limit})) {}

  /// Whether the line crosses `triangle`, and where.
  bool crosses(const Triangle& triangle, Hit& hit) const {
    const scalar::CornersOf<float> corners{vec_of(triangle.a), vec_of(triangle.b),
                                           vec_of(triangle.c)};
    const auto crossing =
        scalar::cross_at<Kernel, float>(Kernel::template prepare<float>(corners), line);
    if (!crossing.met) return false;
    hit = {crossing.t, crossing.u, crossing.v, no_triangle};
    return true;
  }

  /// Tests `triangle`, number `index`, where the interval of its padded box is at hand.
  void meet(const Triangle& triangle, std::uint32_t index, const Interval& own, Hit& best) const {
    Hit hit;
    if (crosses(triangle, hit)) irt::meet(index, hit, own, best);
  }
  /// The same without it: it is computed only for a triangle whose sides are passed.
  void meet(const Triangle& triangle, std::uint32_t index, Hit& best) const {
    Hit hit;
    if (crosses(triangle, hit)) {
      irt::meet(index, hit, slab(padded_bounds(triangle), *this), best);
    }
  }
};

/// Calls `body` with an object of the kernel's class.
template <class Body>
void with_kernel(TriangleKernel kernel, Body body) {
  switch (kernel) {
    case TriangleKernel::moller_trumbore:
      return body(scalar::MollerTrumbore());
    case TriangleKernel::projection:
      return body(scalar::Projection());
    case TriangleKernel::kensler_shirley:
      return body(scalar::KenslerShirley());
    case TriangleKernel::watertight:
      return body(scalar::Watertight());
  }
}

/// An accelerator that traces one ray after the other. `Structure` has
/// `template <class Kernel, bool any, class Probe> Hit trace(const KernelRay<Kernel>&, Probe&)`;
/// with `any` it may stop at the first hit that it finds.
template <class Structure>
class SingleRayAccelerator : public Accelerator {
 public:
  /// `name` is for the message: width and isa are for structures that know SIMD.
  SingleRayAccelerator(std::string_view name, const AcceleratorOptions& options)
      : kernel_(options.kernel) {
    if (options.width > 1) {
      throw std::invalid_argument("packet width " + std::to_string(options.width) + ": " +
                                  std::string(name) + " traces single rays; 1 would be right");
    }
    if (!options.isa.empty()) {
      throw std::invalid_argument("instruction set \"" + std::string(options.isa) + "\": " +
                                  std::string(name) + " has scalar code only; none would be right");
    }
  }

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const override {
    for_each_ray<false>(rays, profile, [&](std::uint32_t lane, const Hit& hit) {
      hits.t[lane] = hit.t;
      hits.u[lane] = hit.u;
      hits.v[lane] = hit.v;
      hits.triangle[lane] = hit.triangle;
    });
  }

  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile) const override {
    for_each_ray<true>(rays, profile, [&](std::uint32_t lane, const Hit& hit) {
      occluded[lane] = hit.triangle != no_triangle;
    });
  }

 private:
  template <bool any, class Store>
  void for_each_ray(const Rays& rays, TraceProfile* profile, Store store) const {
    with_kernel(kernel_, [&]<class Kernel>(Kernel) {
      with_profile(profile, [&](auto& probe) {
        for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
          const KernelRay<Kernel> ray(rays.ray(lane));
          store(lane,
                ray.limit > 0
                    ? static_cast<const Structure&>(*this).template trace<Kernel, any>(ray, probe)
                    : no_hit(ray));
        }
      });
    });
  }

  TriangleKernel kernel_;
};

}  // namespace irt
