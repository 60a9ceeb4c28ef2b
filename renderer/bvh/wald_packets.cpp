#include "renderer/bvh/wald_packets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/bvh/wald_packets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/bvh/wald_packets-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

template <class Kernel, int N>
void closest_packets(WaldView tree, const Rays& rays, Hits& hits, TickProbe* probe) {
  WaldTracer<Kernel, N, false> tracer(tree, probe);
  for (std::uint32_t begin = 0; begin < rays.size; begin += tracer.most) {
    const std::uint32_t count = std::min(tracer.most, rays.size - begin);
    tracer.trace(rays, begin, count);
    std::copy_n(tracer.t, count, &hits.t[begin]);
    std::copy_n(tracer.u, count, &hits.u[begin]);
    std::copy_n(tracer.v, count, &hits.v[begin]);
    std::copy_n(tracer.triangle, count, &hits.triangle[begin]);
  }
}

template <class Kernel, int N>
void any_packets(WaldView tree, const Rays& rays, std::span<std::uint8_t> occluded,
                 TickProbe* probe) {
  WaldTracer<Kernel, N, true> tracer(tree, probe);
  for (std::uint32_t begin = 0; begin < rays.size; begin += tracer.most) {
    const std::uint32_t count = std::min(tracer.most, rays.size - begin);
    tracer.trace(rays, begin, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      occluded[begin + i] = tracer.triangle[i] != no_triangle;
    }
  }
}

template <class Kernel>
const WaldPackets* packets_of(unsigned width) {
  static constexpr WaldPackets by_width[]{{closest_packets<Kernel, 4>, any_packets<Kernel, 4>},
                                          {closest_packets<Kernel, 8>, any_packets<Kernel, 8>},
                                          {closest_packets<Kernel, 16>, any_packets<Kernel, 16>}};
  return &by_width[width == 4 ? 0 : width == 8 ? 1 : 2];
}

const WaldPackets* packets_of(TriangleKernel kernel, unsigned width) {
  switch (kernel) {
    case TriangleKernel::projection:
      return packets_of<Projection>(width);
    case TriangleKernel::kensler_shirley:
      return packets_of<KenslerShirley>(width);
    case TriangleKernel::watertight:
      return packets_of<Watertight>(width);
    case TriangleKernel::moller_trumbore:
      break;
  }
  return packets_of<MollerTrumbore>(width);
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "renderer/bvh/simd_targets.hpp"

namespace irt {

const WaldPackets* wald_packets(std::string_view isa, TriangleKernel kernel, unsigned width) {
  using Code = const WaldPackets* (*)(TriangleKernel, unsigned);
  static constexpr SimdTarget<Code> targets[] IRT_SIMD_TARGETS(packets_of);
  check_packet_width(width);
  return code_for<Code>(isa, targets)(kernel, width);
}

}  // namespace irt
#endif  // HWY_ONCE
