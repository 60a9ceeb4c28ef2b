/// How often this thread has asked the C library for memory.
#pragma once

#include <cstdint>

namespace irt::micro {

struct Allocations {
  std::uint64_t count = 0;
  std::uint64_t bytes = 0;
};

/// Since the thread started; all zero in builds with a sanitizer, which brings its own allocator.
Allocations allocations();

}  // namespace irt::micro
