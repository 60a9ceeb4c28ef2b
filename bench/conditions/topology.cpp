#include "bench/conditions/topology.hpp"

#include "bench/conditions/hwloc.hpp"

namespace irt {
namespace {

/// Objects of `type` that hold at least one processor of `allowed`.
unsigned count_within(hwloc_topology_t topology, hwloc_obj_type_t type,
                      hwloc_const_cpuset_t allowed) {
  unsigned count = 0;
  for (hwloc_obj_t object = nullptr;
       (object = hwloc_get_next_obj_by_type(topology, type, object)) != nullptr;) {
    if (hwloc_bitmap_intersects(object->cpuset, allowed) != 0) ++count;
  }
  return count;
}

}  // namespace

Topology survey_topology() {
  const HwlocTopology loaded = load_hwloc();
  hwloc_topology_t topology = loaded.get();
  const HwlocSet allowed = allowed_processors(topology);

  Topology found;
  found.packages = count_within(topology, HWLOC_OBJ_PACKAGE, allowed.get());
  found.numa_nodes = count_within(topology, HWLOC_OBJ_NUMANODE, allowed.get());
  found.hardware_threads = count_within(topology, HWLOC_OBJ_PU, allowed.get());
  found.cores = count_within(topology, HWLOC_OBJ_CORE, allowed.get());
  if (found.cores == 0) found.cores = found.hardware_threads;  // the system does not tell
  found.machine_threads =
      static_cast<unsigned>(hwloc_bitmap_weight(hwloc_topology_get_complete_cpuset(topology)));
  found.mixed_cores = hwloc_cpukinds_get_nr(topology, 0) > 1;

  for (const hwloc_obj_type_t type : {HWLOC_OBJ_L1CACHE, HWLOC_OBJ_L1ICACHE, HWLOC_OBJ_L2CACHE,
                                      HWLOC_OBJ_L3CACHE, HWLOC_OBJ_L4CACHE}) {
    const unsigned instances = count_within(topology, type, allowed.get());
    if (instances == 0) continue;
    const auto& cache = hwloc_get_obj_by_type(topology, type, 0)->attr->cache;
    found.caches.push_back({.level = cache.depth,
                            .instructions = cache.type == HWLOC_OBJ_CACHE_INSTRUCTION,
                            .bytes = cache.size,
                            .instances = instances,
                            .line_bytes = cache.linesize});
  }
  return found;
}

}  // namespace irt
