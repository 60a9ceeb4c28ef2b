#include <algorithm>
#include <chrono>

#include "bench/tracer/contestant.hpp"
#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide/build.hpp"

namespace irt::tracer {
namespace {

/// As "wide 16" or "wide 16 watertight"; the default kernel is not named.
std::string name_of(const AcceleratorEntry& entry, unsigned width,
                    const TriangleKernelEntry& kernel) {
  std::string name(entry.name);
  name += ' ' + std::to_string(width);
  if (kernel.kernel != triangle_kernels().front().kernel) name += ' ' + std::string(kernel.name);
  return name;
}

/// Calls `each(name, entry, kernel, width)` for everything there is.
template <class Each>
void for_each_way(Each each) {
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == "none") continue;
    const bool packets = entry.name != "goncalves";
    for (const TriangleKernelEntry& kernel : triangle_kernels()) {
      for (const unsigned width : {1u, 4u, 8u, 16u}) {
        if (width == 1 || packets) each(name_of(entry, width, kernel), entry, kernel.kernel, width);
      }
    }
  }
}

}  // namespace

bool is_wanted(std::string_view name, std::span<const std::string> wanted) {
  return std::ranges::any_of(wanted,
                             [&](const std::string& one) { return one == "all" || one == name; });
}

std::span<const std::string_view> usual_contestants() {
  static constexpr std::string_view names[] = {"wide 1",       "wide 4",    "wide 8",
                                               "wide 16",      "embree 1",  "embree 4",
                                               "embree 8",     "embree 16", "embree 16 incoherent",
                                               "embree stream"};
  return names;
}

Contestants our_contestants(const Mesh& mesh, std::span<const std::string> wanted) {
  Contestants contestants;
  for_each_way([&](const std::string& name, const AcceleratorEntry& entry, TriangleKernel kernel,
                   unsigned width) {
    if (!is_wanted(name, wanted)) return;
    contestants.push_back({name, true, kernel == triangle_kernels().front().kernel,
                           entry.build(mesh, {.kernel = kernel, .width = width})});
  });
  return contestants;
}

std::vector<std::string> our_names() {
  std::vector<std::string> names;
  for_each_way([&](const std::string& name, const AcceleratorEntry&, TriangleKernel, unsigned) {
    names.push_back(name);
  });
  return names;
}

TimedBuild time_our_build(const Mesh& mesh, unsigned threads) {
  ThreadExecutor executor(threads);
  const auto start = std::chrono::steady_clock::now();
  const WideBvh bvh = build_wide(mesh, executor);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  return {"wide", taken.count(), bvh.sah_cost};
}

}  // namespace irt::tracer
