/// The corners of triangles in registers. Included once per instruction set.
#if defined(IRT_WIDE_CORNERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_CORNERS_INL
#undef IRT_WIDE_CORNERS_INL
#else
#define IRT_WIDE_CORNERS_INL
#endif

#include <cstdint>
#include <hwy/highway.h>

#include "renderer/bvh/wide/split-inl.hpp"
#include "renderer/scene/scene.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// Reads four floats where a vertex has three: the fourth lane holds anything.
class Corners {
 public:
  /// `mesh` has triangles, and outlives this.
  explicit Corners(const Mesh& mesh)
      : triangles_(mesh.triangles.data()),
        vertices_(mesh.vertices.data()),
        last_(static_cast<std::uint32_t>(mesh.vertices.size() - 1)) {
    const Vec3 vertex = mesh.vertices.back();
    for (int axis = 0; axis < 3; ++axis) last_vertex_[axis] = vertex[axis];
  }

  HWY_INLINE FourFloats operator()(std::uint32_t triangle, std::size_t k) const {
    const std::uint32_t index = triangles_[triangle][k];
    // Behind the last vertex there is nothing to read.
    return hn::LoadU(Four(), index == last_ ? last_vertex_ : &vertices_[index].x);
  }

 private:
  const TriangleIndices* triangles_;
  const Vec3* vertices_;
  std::uint32_t last_;
  float last_vertex_[4] = {};
};

/// The box of a triangle and its number: irt::padded_bounds in the lanes of two vectors.
HWY_INLINE Reference reference_to(const Corners& corners, std::uint32_t triangle) {
  const Four d;
  const FourFloats a = corners(triangle, 0), b = corners(triangle, 1), c = corners(triangle, 2);
  const FourFloats lower = hn::Min(hn::Min(a, b), c), upper = hn::Max(hn::Max(a, b), c);
  const FourFloats far = hn::Max(hn::Neg(lower), upper);
  const FourFloats largest =
      hn::Max(hn::Broadcast<0>(far), hn::Max(hn::Broadcast<1>(far), hn::Broadcast<2>(far)));
  const FourFloats pad = hn::Mul(largest, hn::Set(d, box_pad));
  return {hn::Sub(lower, pad), hn::Neg(hn::Add(upper, pad)), triangle};
}

/// Fills a block with four triangles.
HWY_INLINE void set_block(const Corners& corners, const std::uint32_t (&triangles)[wide_block],
                          WideBlock& block) {
  static_assert(wide_block == 4);
  const Four d;
  for (std::size_t k = 0; k < 3; ++k) {
    const FourFloats t0 = corners(triangles[0], k), t1 = corners(triangles[1], k);
    const FourFloats t2 = corners(triangles[2], k), t3 = corners(triangles[3], k);
    const FourFloats lower01 = hn::InterleaveLower(d, t0, t1);  // x0 x1 y0 y1
    const FourFloats lower23 = hn::InterleaveLower(d, t2, t3);
    const FourFloats z01 = hn::InterleaveUpper(d, t0, t1), z23 = hn::InterleaveUpper(d, t2, t3);
    hn::Store(hn::ConcatLowerLower(d, lower23, lower01), d, block.corner[k][0]);
    hn::Store(hn::ConcatUpperUpper(d, lower23, lower01), d, block.corner[k][1]);
    hn::Store(hn::ConcatLowerLower(d, z23, z01), d, block.corner[k][2]);
  }
  for (std::size_t lane = 0; lane < wide_block; ++lane) block.index[lane] = triangles[lane];
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
