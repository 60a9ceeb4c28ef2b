/// What hwloc says about the processors this process may use.
#pragma once

#include <cstdint>
#include <vector>

namespace irt {

/// One level of cache.
struct CacheLevel {
  unsigned level = 0;         ///< 1 is nearest to the core
  bool instructions = false;  ///< an instruction cache; else data or unified
  std::uint64_t bytes = 0;    ///< of one instance
  unsigned instances = 0;
  unsigned line_bytes = 0;
};

/// Processors as this process sees them: what a cpuset or affinity mask takes away is not counted.
struct Topology {
  unsigned packages = 0;
  unsigned numa_nodes = 0;
  unsigned cores = 0;
  unsigned hardware_threads = 0;
  unsigned machine_threads = 0;  ///< of the whole machine, allowed or not
  bool mixed_cores = false;      ///< fast and slow cores side by side
  std::vector<CacheLevel> caches;

  [[nodiscard]] bool smt() const { return hardware_threads > cores; }
};

/// Asks hwloc. Throws std::runtime_error where it cannot read the machine.
Topology survey_topology();

}  // namespace irt
