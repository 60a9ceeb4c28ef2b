/// The list of structures: a new one adds its header and its line.
#include <array>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/brute_force.hpp"
#include "renderer/bvh/goncalves.hpp"
#include "renderer/bvh/wide.hpp"

namespace irt {
namespace {

template <class Structure>
std::unique_ptr<Accelerator> build(const Mesh& mesh) {
  return std::make_unique<Structure>(mesh);
}

constexpr std::array entries{
    AcceleratorEntry{"wide", "eight children per node, SIMD, built in parallel: the fastest",
                     build<Wide>},
    AcceleratorEntry{"goncalves", "binary, pointers, one triangle per leaf (thesis 5.1)",
                     build<Goncalves>},
    AcceleratorEntry{"none", "every ray meets every triangle", build<BruteForce>},
};

}  // namespace

std::span<const AcceleratorEntry> accelerators() {
  return entries;
}

}  // namespace irt
