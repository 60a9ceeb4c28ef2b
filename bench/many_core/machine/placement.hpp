/// Which hardware thread of a machine each thread of a run has.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "bench/many_core/profiles/profile.hpp"

namespace irt::many_core {

enum class Placement : std::uint8_t {
  close,     ///< a core each, neighbours first; second hardware threads last
  siblings,  ///< neighbours first, both hardware threads of a core together
  spread,    ///< a core each, alternating between sockets
};
std::string_view name_of(Placement placement);

/// The hardware thread of each of `threads` threads, by the profile's numbers. More threads than
/// the machine has share its hardware threads in turn.
std::vector<unsigned> place(const Profile& profile, unsigned threads, Placement placement);

/// A number of threads up to which all are within one group of the machine, and with one more no
/// longer.
struct Level {
  unsigned threads;
  std::string_view name;  ///< "one cache"
};
/// The levels that threads placed so pass, by rising number; at 2 threads and more.
std::vector<Level> levels(const Profile& profile, Placement placement);

}  // namespace irt::many_core
