/// This machine as hwloc has read it, for who asks it more than topology.hpp tells.
#pragma once

#include <hwloc.h>
#include <memory>

namespace irt {

using HwlocTopology = std::unique_ptr<hwloc_topology, decltype(&hwloc_topology_destroy)>;
using HwlocSet = std::unique_ptr<hwloc_bitmap_s, decltype(&hwloc_bitmap_free)>;

/// Takes some milliseconds. Throws std::runtime_error where hwloc cannot read the machine.
HwlocTopology load_hwloc();

/// The processors that this process may use.
HwlocSet allowed_processors(hwloc_topology_t topology);

}  // namespace irt
