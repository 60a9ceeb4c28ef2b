/// The default structure: a wide hierarchy for SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide_bvh.hpp"

namespace irt {

/// A bounding volume hierarchy with eight children per node and four triangles per block, built by
/// binned surface area heuristic; see build_wide.
///
/// Use it wherever speed counts. The thesis' own structures are `goncalves` and `wald`.
///
/// A ray tests the eight boxes of a node, and the four triangles of a block, with one sequence of
/// SIMD instructions each. The instruction set is chosen when the program runs: the best of SSE4,
/// AVX2 and AVX-512 that the processor has (on x86). All give the same bits.
class Wide final : public Accelerator {
 public:
  /// Builds with a thread per core.
  explicit Wide(const Mesh& mesh);
  /// Builds on `executor`, which is not needed any longer afterwards.
  Wide(const Mesh& mesh, Executor& executor);

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile = nullptr) const override;
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* profile = nullptr) const override;
  std::size_t memory_bytes() const override { return bvh_.memory_bytes(); }

  const WideBvh& bvh() const { return bvh_; }

 private:
  WideBvh bvh_;
};

}  // namespace irt
