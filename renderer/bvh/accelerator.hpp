/// What every acceleration structure answers: the first hit, and whether there is any.
///
/// With the same triangle test all structures give the same answer to the last bit. Two rules make
/// that provable:
///  - Of several triangles at the same distance the one with the lowest index is hit.
///  - A hit's distance is clamped to the slab interval of the triangle's own bounding box, which
///    is computed by the same monotone operations as that of any box around it. So an ancestor
///    that does not contain the hit's distance cannot exist, whatever the tree and its order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/rays.hpp"

namespace irt {

/// Time that one call spent walking the structure and in triangle tests (thesis, table 5.4).
struct TraceProfile {
  std::uint64_t traverse_ns = 0;
  std::uint64_t intersect_ns = 0;
};

class Executor;

/// A built structure over one mesh, which must outlive it. Queries are const and thread-safe.
class Accelerator {
 public:
  Accelerator() = default;
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;
  virtual ~Accelerator() = default;

  /// The first triangle that each of `rays` meets, in the lanes [0, rays.size) of `hits`.
  /// With a `profile`, the call is timed and the time added to it; that is slower.
  virtual void closest_hit(const Rays& rays, Hits& hits, TraceProfile* profile = nullptr) const = 0;

  /// Per ray of `rays`, 1 where some triangle is met before `t_max`, else 0. `occluded` has at
  /// least `rays.size` elements.
  virtual void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
                       TraceProfile* profile = nullptr) const = 0;

  /// Bytes that the structure occupies beside the mesh.
  [[nodiscard]] virtual std::size_t memory_bytes() const = 0;

  /// Adapts the structure to `mesh`, which has the triangles that it was built over at other
  /// places. Quicker than to build anew, with the same answers, which take the longer to find the
  /// further triangles have moved. No query runs meanwhile. False where the structure cannot.
  virtual bool refit(const Mesh& /*mesh*/, Executor& /*executor*/) { return false; }

  /// What a ray is expected to cost, by the surface area heuristic. Only its growth from refit to
  /// refit means anything; the unit is the structure's own.
  [[nodiscard]] virtual double sah_cost() const { return 1; }
};

/// How a ray is tested against a triangle: the classes of renderer/tracing/kernels-inl.hpp.
enum class TriangleKernel : std::uint8_t {
  moller_trumbore,
  projection,
  kensler_shirley,
  watertight,
};

/// A kernel by name, as the tools see it.
struct TriangleKernelEntry {
  TriangleKernel kernel;
  std::string_view name;
  std::string_view summary;
};

/// All kernels, the default first.
std::span<const TriangleKernelEntry> triangle_kernels();

/// How a structure is built and traced. Of all this only the kernel has a say in the answers.
struct AcceleratorOptions {
  TriangleKernel kernel = TriangleKernel::moller_trumbore;
  /// Rays per packet: 1, 4, 8 or 16; 0 takes what the structure does by default.
  unsigned width = 0;
  /// The instruction set: "sse4", "avx2", "avx512"; empty takes the best that the machine has.
  std::string_view isa{};
  /// Runs the parallel parts of the build; null stands for as many threads as there are cores.
  Executor* executor = nullptr;
};

/// A structure by name, as the tools see it.
struct AcceleratorEntry {
  std::string_view name;
  std::string_view summary;
  /// Throws std::invalid_argument where the structure or the machine lacks an option.
  std::unique_ptr<Accelerator> (*build)(const Mesh& mesh, const AcceleratorOptions& options);
};

/// All structures, the default first.
std::span<const AcceleratorEntry> accelerators();

}  // namespace irt
