/// The default structure: a wide hierarchy for SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide_bvh.hpp"

namespace irt {

/// How rays go through the wide hierarchy. The answers are the same.
struct WideOptions {
  /// Rays per packet: 1, 4, 8 or 16, but no more than a vector of the processor holds. 1: every ray
  /// on its own, SIMD over boxes and triangles only.
  int width = 16;
  /// Whether 16 packets at a time share the upper part of the way. Pays for primary and shadow
  /// rays; others hardly lose by it.
  bool groups = true;
};

/// A bounding volume hierarchy with eight children per node and four triangles per block, built by
/// binned surface area heuristic; see build_wide.
///
/// Use it wherever speed counts. The thesis' own structures are `goncalves` and `wald`.
///
/// Rays are traced as they lie in the batch: lanes [p * width, (p + 1) * width) are packet p, and
/// 16 packets make a group. So neighbours in a batch should be neighbours in space. The instruction
/// set is chosen when the program runs: the best of SSE4, AVX2 and AVX-512 that the processor has
/// (on x86). All give the same bits.
class Wide final : public Accelerator {
 public:
  /// Builds with a thread per core.
  explicit Wide(const Mesh& mesh);
  /// Builds on `executor`, which is not needed any longer afterwards.
  Wide(const Mesh& mesh, Executor& executor, const WideOptions& options = {});

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile = nullptr) const override {
    closest_hit(rays, hits, options_, profile);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile = nullptr) const override {
    any_hit(rays, occluded, options_, profile);
  }

  /// The same with other options than those it was built with.
  void closest_hit(const Rays& rays, Hits& hits, const WideOptions& options,
                   TraceProfile* profile = nullptr) const;
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded, const WideOptions& options,
               TraceProfile* profile = nullptr) const;

  std::size_t memory_bytes() const override { return bvh_.memory_bytes(); }

  const WideBvh& bvh() const { return bvh_; }

 private:
  WideBvh bvh_;
  WideOptions options_;
};

}  // namespace irt
