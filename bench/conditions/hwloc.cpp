#include "bench/conditions/hwloc.hpp"

#include <stdexcept>

namespace irt {

HwlocTopology load_hwloc() {
  hwloc_topology_t raw = nullptr;
  if (hwloc_topology_init(&raw) != 0) throw std::runtime_error("hwloc: cannot start");
  HwlocTopology topology(raw, &hwloc_topology_destroy);
  hwloc_topology_set_type_filter(raw, HWLOC_OBJ_L1ICACHE, HWLOC_TYPE_FILTER_KEEP_ALL);
  if (hwloc_topology_load(raw) != 0) {
    throw std::runtime_error("hwloc: cannot read this machine's processors");
  }
  return topology;
}

HwlocSet allowed_processors(hwloc_topology_t topology) {
  HwlocSet allowed(hwloc_bitmap_alloc(), &hwloc_bitmap_free);
  if (hwloc_get_cpubind(topology, allowed.get(), HWLOC_CPUBIND_PROCESS) != 0) {
    hwloc_bitmap_copy(allowed.get(), hwloc_topology_get_allowed_cpuset(topology));
  }
  return allowed;
}

}  // namespace irt
