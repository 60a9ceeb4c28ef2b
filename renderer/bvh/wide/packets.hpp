/// Batches of rays through the wide hierarchy: what the structure sees of it.
#pragma once

#include <cstdint>
#include <string_view>

#include "renderer/bvh/accelerator.hpp"
#include "renderer/bvh/ray_loop.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"

namespace irt {

/// One way through: a width and a kernel, with the two queries compiled for one instruction set.
/// Without a probe the pointer is null.
struct WideWay {
  unsigned width;    ///< rays per packet: 1, 4, 8 or 16
  const void* code;  ///< the KernelCode of that instruction set
  void (*closest)(const WideBvh& bvh, const WideWay& way, const Rays& rays, Hits& hits,
                  TickProbe* probe);
  void (*any)(const WideBvh& bvh, const WideWay& way, const Rays& rays, std::uint8_t* occluded,
              TickProbe* probe);
};

/// The way of AcceleratorOptions. Throws std::invalid_argument where the machine lacks it.
WideWay wide_way(std::string_view isa, TriangleKernel kernel, unsigned width);

}  // namespace irt
