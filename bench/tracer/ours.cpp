#include <algorithm>
#include <chrono>

#include "bench/tracer/contestant.hpp"
#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide_build.hpp"

namespace irt::bench {
namespace {

/// A structure traced one way.
class Structure final : public Contestant {
 public:
  Structure(std::string name, bool default_kernel, std::unique_ptr<Accelerator> accelerator)
      : name_(std::move(name)),
        default_kernel_(default_kernel),
        accelerator_(std::move(accelerator)) {}

  std::string_view name() const override { return name_; }
  bool is_ours() const override { return true; }
  bool same_bits() const override { return default_kernel_; }
  void closest_hit(const Rays& rays, Hits& hits) const override {
    accelerator_->closest_hit(rays, hits);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded) const override {
    accelerator_->any_hit(rays, occluded);
  }

 private:
  std::string name_;
  bool default_kernel_;
  std::unique_ptr<Accelerator> accelerator_;
};

/// As "wide 16" or "wide 16 watertight"; the default kernel is not named.
std::string name_of(const AcceleratorEntry& entry, unsigned width,
                    const TriangleKernelEntry& kernel) {
  std::string name(entry.name);
  name += ' ' + std::to_string(width);
  if (kernel.kernel != triangle_kernels().front().kernel) name += ' ' + std::string(kernel.name);
  return name;
}

}  // namespace

bool is_wanted(std::string_view name, std::span<const std::string> wanted) {
  return std::any_of(wanted.begin(), wanted.end(),
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
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == "none") continue;
    const bool packets = entry.name != "goncalves";
    for (const TriangleKernelEntry& kernel : triangle_kernels()) {
      for (const unsigned width : {1u, 4u, 8u, 16u}) {
        std::string name = name_of(entry, width, kernel);
        if ((width > 1 && !packets) || !is_wanted(name, wanted)) continue;
        contestants.push_back(std::make_unique<Structure>(
            std::move(name), kernel.kernel == triangle_kernels().front().kernel,
            entry.build(mesh, {.kernel = kernel.kernel, .width = width})));
      }
    }
  }
  return contestants;
}

TimedBuild time_our_build(const Mesh& mesh, unsigned threads) {
  ThreadExecutor executor(threads);
  const auto start = std::chrono::steady_clock::now();
  const WideBvh bvh = build_wide(mesh, executor);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  return {"wide", taken.count(), bvh.sah_cost};
}

}  // namespace irt::bench
