/// The one property of every accelerator: the bits of brute force.
#pragma once

#include <bit>
#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {

/// What brute force answers, computed once for all structures.
struct Expected {
  Hits hits;
  std::uint32_t hit_count = 0;
};

inline Expected brute_force(const Mesh& mesh, const Rays& rays,
                            const AcceleratorOptions& options = {}) {
  Expected expected{Hits(rays.size)};
  build("none", mesh, options)->closest_hit(rays, expected.hits);
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    expected.hit_count += expected.hits.triangle[i] != no_triangle;
  }
  return expected;
}

/// Both queries of `accelerator` against brute force, to the bit.
inline void expect_agreement(const Accelerator& accelerator, const Rays& rays,
                             const Expected& expected) {
  Hits hits(rays.size);
  std::vector<std::uint8_t> occluded(rays.size, 2);
  accelerator.closest_hit(rays, hits);
  accelerator.any_hit(rays, occluded);
  std::uint32_t wrong = 0;
  for (std::uint32_t i = 0; i < rays.size && wrong < 5; ++i) {
    const bool hit = expected.hits.triangle[i] != no_triangle;
    const bool same = hits.triangle[i] == expected.hits.triangle[i] &&
                      occluded[i] == std::uint8_t{hit} &&
                      (!hit || (std::bit_cast<std::uint32_t>(hits.t[i]) ==
                                    std::bit_cast<std::uint32_t>(expected.hits.t[i]) &&
                                std::bit_cast<std::uint32_t>(hits.u[i]) ==
                                    std::bit_cast<std::uint32_t>(expected.hits.u[i]) &&
                                std::bit_cast<std::uint32_t>(hits.v[i]) ==
                                    std::bit_cast<std::uint32_t>(expected.hits.v[i])));
    if (same) continue;
    ++wrong;
    ADD_FAILURE() << "ray " << i << ": triangle " << hits.triangle[i] << " at " << hits.t[i]
                  << ", occluded " << int{occluded[i]}
                  << "; brute force: " << expected.hits.triangle[i] << " at " << expected.hits.t[i];
  }
}

/// All structures that take `kernel` on one mesh and one bundle; returns how many rays hit
/// something.
inline std::uint32_t expect_all_agree(const Mesh& mesh, const Rays& rays,
                                      TriangleKernel kernel = TriangleKernel::moller_trumbore) {
  const AcceleratorOptions options{.kernel = kernel};
  const Expected expected = brute_force(mesh, rays, options);
  for (const std::string& name : structure_names()) {
    SCOPED_TRACE(name);
    std::unique_ptr<Accelerator> accelerator;
    try {
      accelerator = build(name, mesh, options);
    } catch (const std::invalid_argument&) {
      EXPECT_NE(kernel, TriangleKernel::moller_trumbore) << "every structure takes the default";
      continue;
    }
    expect_agreement(*accelerator, rays, expected);
  }
  return expected.hit_count;
}

}  // namespace irt::test
