/// The list of structures: a new one adds its header and its line.
#include <array>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/brute_force.hpp"
#include "renderer/bvh/goncalves.hpp"
#include "renderer/bvh/wald.hpp"
#include "renderer/bvh/wide/wide.hpp"

namespace irt {
namespace {

template <class Structure>
std::unique_ptr<Accelerator> build(const Mesh& mesh, const AcceleratorOptions& options) {
  return std::make_unique<Structure>(mesh, options);
}

constexpr std::array entries{
    AcceleratorEntry{"wide", "eight children per node, SIMD, built in parallel: the fastest",
                     build<Wide>},
    AcceleratorEntry{"goncalves", "binary, pointers, one triangle per leaf (thesis 5.1)",
                     build<Goncalves>},
    AcceleratorEntry{"wald",
                     "binary, 32-byte nodes, full SAH sweep, packets on request (thesis 5.2)",
                     build<Wald>},
    AcceleratorEntry{"none", "every ray meets every triangle", build<BruteForce>},
};

constexpr std::array kernels{
    TriangleKernelEntry{TriangleKernel::moller_trumbore, "moller-trumbore",
                        "least memory (Möller, Trumbore 1997)"},
    TriangleKernelEntry{TriangleKernel::kensler_shirley, "kensler-shirley",
                        "precomputed normal (Kensler, Shirley 2006)"},
    TriangleKernelEntry{TriangleKernel::projection, "projection",
                        "the thesis' projection test (Wald 2004, Bikker)"},
    TriangleKernelEntry{TriangleKernel::watertight, "watertight",
                        "no ray passes between triangles (Woop, Benthin, Wald 2013)"},
};

}  // namespace

std::span<const TriangleKernelEntry> triangle_kernels() {
  return kernels;
}

std::span<const AcceleratorEntry> accelerators() {
  return entries;
}

}  // namespace irt
