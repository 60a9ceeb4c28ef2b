/// The default structure: a wide hierarchy for SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/wide/packets.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"

namespace irt {

/// A bounding volume hierarchy with eight children per node and four triangles per block, built by
/// binned surface area heuristic; see build_wide.
///
/// Use it wherever speed counts. The thesis' own structures are `goncalves` and `wald`.
///
/// Rays are traced as they lie in the batch: lanes [p * width, (p + 1) * width) are packet p, and
/// 16 packets make a group. So neighbours in a batch should be neighbours in space. With a width of
/// 1 every ray goes on its own, SIMD over boxes and triangles only. By default packets are as wide
/// as the vectors of the instruction set, and that is the best that the machine has. All give the
/// same bits.
class Wide final : public Accelerator {
 public:
  /// Throws std::invalid_argument where an option is unknown or the machine lacks it.
  Wide(const Mesh& mesh, const AcceleratorOptions& options);

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile = nullptr) const override;
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile = nullptr) const override;

  [[nodiscard]] std::size_t memory_bytes() const override { return bvh_.memory_bytes(); }
  bool refit(const Mesh& mesh, Executor& executor) override;
  [[nodiscard]] double sah_cost() const override { return bvh_.sah_cost; }

  [[nodiscard]] const WideBvh& bvh() const { return bvh_; }

 private:
  WideWay way_;
  WideBvh bvh_;
};

}  // namespace irt
