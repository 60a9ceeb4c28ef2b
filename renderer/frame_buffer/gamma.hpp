/// From light to the bytes of a picture.
#pragma once

#include <cstddef>
#include <cstdint>

namespace irt {

/// Each of `count` channels, none negative or a NaN, as a byte: its square root (gamma 2), 1 and
/// more being 255. The same bytes on every instruction set.
void to_bytes(const float* linear, std::size_t count, std::uint8_t* bytes);

}  // namespace irt
