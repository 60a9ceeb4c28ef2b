/// Choosing among the instruction sets that a source was compiled for, by name.
///
/// Include it after Highway, in the part of a source that is compiled once.
#pragma once

#include <array>
#include <cstdint>
#include <hwy/targets.h>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "renderer/bvh/accelerator.hpp"

namespace irt {

/// What a source has for one instruction set.
template <class Code>
struct SimdTarget {
  std::int64_t bit;
  std::string_view isa;
  Code code;
};

#if HWY_TARGETS & HWY_AVX3
#define IRT_SIMD_AVX512(function) {HWY_AVX3, "avx512", N_AVX3::function},
#else
#define IRT_SIMD_AVX512(function)
#endif
#if HWY_TARGETS & HWY_AVX2
#define IRT_SIMD_AVX2(function) {HWY_AVX2, "avx2", N_AVX2::function},
#else
#define IRT_SIMD_AVX2(function)
#endif
#if HWY_TARGETS & HWY_SSE4
#define IRT_SIMD_SSE4(function) {HWY_SSE4, "sse4", N_SSE4::function},
#else
#define IRT_SIMD_SSE4(function)
#endif
#if HWY_TARGETS & HWY_NEON
#define IRT_SIMD_NEON(function) {HWY_NEON, "neon", N_NEON::function},
#else
#define IRT_SIMD_NEON(function)
#endif
/// Initializes an array of SimdTarget, the best first.
#define IRT_SIMD_TARGETS(function)                                          \
  {                                                                         \
    IRT_SIMD_AVX512(function)                                               \
    IRT_SIMD_AVX2(function) IRT_SIMD_SSE4(function) IRT_SIMD_NEON(function) \
  }

/// The code for `isa`, the best that the machine has where it is empty. Throws
/// std::invalid_argument where the machine or the source lacks it.
template <class Code>
Code code_for(std::string_view isa, std::span<const SimdTarget<Code>> targets) {
  const std::int64_t supported = hwy::SupportedTargets();
  std::string names;
  for (const SimdTarget<Code>& target : targets) {
    if ((supported & target.bit) == 0) continue;
    if (isa.empty() || isa == target.isa) return target.code;
    names += (names.empty() ? "" : ", ") + std::string(target.isa);
  }
  throw std::invalid_argument("instruction set \"" + std::string(isa) + "\": this machine has " +
                              names);
}

/// Throws std::invalid_argument unless `width` is one of packets.
inline void check_packet_width(unsigned width) {
  if (width == 0 || width == 1 || width == 4 || width == 8 || width == 16) return;
  throw std::invalid_argument("packet width " + std::to_string(width) +
                              ": 1, 4, 8 or 16 would be right, or 0 for the default");
}

}  // namespace irt
