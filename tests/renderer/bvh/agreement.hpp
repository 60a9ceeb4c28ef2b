/// The one property of every accelerator: the bits of brute force.
#pragma once

#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "renderer/bvh/executor.hpp"
#include "tests/renderer/bvh/meshes.hpp"

namespace irt::test {

inline constexpr float inf = std::numeric_limits<float>::infinity();
inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();

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

/// The structure `name` with every kernel, packet width and instruction set against brute force;
/// returns how many rays hit something by the default kernel.
inline std::uint32_t expect_every_way_agrees(std::string_view name, const Mesh& mesh,
                                             const Rays& rays) {
  ThreadExecutor executor(1);
  const std::array all{1u, 4u, 8u, 16u};
  const std::span widths = std::span(all).subspan(name == "wald" ? 1 : 0);
  std::uint32_t hit_count = 0;
  std::size_t tried = 0;
  for (const TriangleKernelEntry& kernel : triangle_kernels()) {
    const Expected expected = brute_force(mesh, rays, {.kernel = kernel.kernel});
    if (kernel.kernel == TriangleKernel::moller_trumbore) hit_count = expected.hit_count;
    for (const char* const isa : {"", "sse4", "avx2", "avx512", "neon"}) {
      for (const unsigned width : widths) {
        SCOPED_TRACE(::testing::Message() << kernel.name << " " << isa << " width " << width);
        std::unique_ptr<Accelerator> accelerator;
        try {
          accelerator = build(name, mesh, {kernel.kernel, width, isa, &executor});
        } catch (const std::invalid_argument&) {
          continue;  // not an instruction set of this machine
        }
        ++tried;
        expect_agreement(*accelerator, rays, expected);
      }
    }
  }
  // On the machine's best, and on that one by its name.
  EXPECT_GE(tried, 2 * widths.size() * triangle_kernels().size());
  return hit_count;
}

}  // namespace irt::test
