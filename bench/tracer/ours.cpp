#include <algorithm>
#include <array>
#include <chrono>

#include "bench/tracer/contestant.hpp"
#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/wide.hpp"
#include "renderer/bvh/wide_build.hpp"

namespace irt::bench {
namespace {

/// A structure by name with its own defaults.
class Structure final : public Contestant {
 public:
  Structure(const AcceleratorEntry& entry, const Mesh& mesh)
      : name_(entry.name), accelerator_(entry.build(mesh, {})) {}

  std::string_view name() const override { return name_; }
  bool is_ours() const override { return true; }
  void closest_hit(const Rays& rays, Hits& hits) const override {
    accelerator_->closest_hit(rays, hits);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded) const override {
    accelerator_->any_hit(rays, occluded);
  }

 private:
  std::string name_;
  std::unique_ptr<Accelerator> accelerator_;
};

/// One of several ways through the same hierarchy.
class WideWay final : public Contestant {
 public:
  WideWay(std::string_view name, std::shared_ptr<const Wide> wide, const WideOptions& options)
      : name_(name), wide_(std::move(wide)), options_(options) {}

  std::string_view name() const override { return name_; }
  bool is_ours() const override { return true; }
  void closest_hit(const Rays& rays, Hits& hits) const override {
    wide_->closest_hit(rays, hits, options_);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded) const override {
    wide_->any_hit(rays, occluded, options_);
  }

 private:
  std::string_view name_;
  std::shared_ptr<const Wide> wide_;
  WideOptions options_;
};

struct Way {
  std::string_view name;
  WideOptions options;
};
constexpr std::array ways{
    Way{"wide single", {1, false}},    Way{"wide 4", {4, false}},
    Way{"wide 8", {8, false}},         Way{"wide 16", {16, false}},
    Way{"wide 4 groups", {4, true}},   Way{"wide 8 groups", {8, true}},
    Way{"wide 16 groups", {16, true}},
};

}  // namespace

bool is_wanted(std::string_view name, std::span<const std::string> wanted) {
  return std::any_of(wanted.begin(), wanted.end(),
                     [&](const std::string& one) { return one == "all" || one == name; });
}

std::span<const std::string_view> usual_contestants() {
  static constexpr std::string_view names[] = {
      "wide single", "wide 4 groups", "wide 8 groups", "wide 16 groups",       "embree 1",
      "embree 4",    "embree 8",      "embree 16",     "embree 16 incoherent", "embree stream"};
  return names;
}

Contestants our_contestants(const Mesh& mesh, std::span<const std::string> wanted) {
  Contestants contestants;
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == "wide" || entry.name == "none") continue;
    if (!is_wanted(entry.name, wanted)) continue;
    contestants.push_back(std::make_unique<Structure>(entry, mesh));
  }
  std::shared_ptr<const Wide> wide;
  for (const Way& way : ways) {
    if (!is_wanted(way.name, wanted)) continue;
    if (!wide) wide = std::make_shared<Wide>(mesh);
    contestants.push_back(std::make_unique<WideWay>(way.name, wide, way.options));
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
