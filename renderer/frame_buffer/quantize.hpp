/// Light as integers, many channels at a time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace irt {

/// `FixedPointSum::quantize` of each of `count` channels. The same integers on every instruction
/// set.
void quantize(const float* light, std::size_t count, std::uint64_t* integers);

}  // namespace irt
