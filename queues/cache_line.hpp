/// How far apart two things must lie so that writing one does not slow the other.
#pragma once

#include <cstddef>

namespace irt {

/// In bytes. Two lines of 64, because x86 prefetches lines in pairs. Not
/// `std::hardware_destructive_interference_size`: that one changes with compiler flags, and with it
/// the layout of a queue.
inline constexpr std::size_t cache_line_pair = 128;

}  // namespace irt
