/// A structure over a mesh that moves from frame to frame.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/executor.hpp"

namespace irt {

/// What is done when the mesh has moved.
enum class Update : std::uint8_t {
  /// Refits, and rebuilds when that has become cheaper; see DynamicAccelerator.
  by_cost,
  refit,
  rebuild,
};

/// An update by name, as the tools see it.
struct UpdateEntry {
  std::string_view name;
  std::string_view summary;
  Update update;
};

/// All updates, the default first.
std::span<const UpdateEntry> updates();

/// Any structure, kept up to date.
///
/// A refitted tree is worse than a new one, and every frame pays for it. By cost: after each frame
/// the time that the refitted tree has cost more is added up, taken from the frame's time and the
/// growth of the tree's SAH cost since it was built. Once the sum reaches what a rebuild takes
/// longer than a refit, both as last measured, the tree is rebuilt. That is the rule of the rented
/// ski: never more than twice what the best choice in hindsight would have cost.
class DynamicAccelerator final : public Accelerator {
 public:
  /// Builds at once. `mesh` and the string of `options.isa` outlive the structure; the executor of
  /// the options is not used. Throws as `entry.build`.
  DynamicAccelerator(const AcceleratorEntry& entry, const Mesh& mesh,
                     const AcceleratorOptions& options, Update update, Executor& executor);

  /// Builds over the mesh as it is now.
  void rebuild(Executor& executor);

  /// Takes in that the mesh has moved since the last call. `render_s` is the time that rendering
  /// took since then. True where it has rebuilt.
  bool update(Executor& executor, double render_s);

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile) const override {
    current_->closest_hit(rays, hits, profile);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile) const override {
    current_->any_hit(rays, occluded, profile);
  }
  [[nodiscard]] std::size_t memory_bytes() const override { return current_->memory_bytes(); }
  [[nodiscard]] double sah_cost() const override { return current_->sah_cost(); }

 private:
  bool rebuilding_pays(double render_s);

  const AcceleratorEntry& entry_;
  const Mesh& mesh_;
  AcceleratorOptions options_;
  Update update_;
  std::unique_ptr<Accelerator> current_;
  double cost_when_built_ = 0;
  double rebuild_s_ = 0, refit_s_ = 0;  ///< as last measured
  double lost_s_ = 0;                   ///< to a tree that is not new, since it was built
};

}  // namespace irt
