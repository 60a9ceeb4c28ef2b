/// On which processors the threads of a measurement run.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace irt::contention {

/// A hardware thread and where it belongs. Numbers of one kind are unique over the whole machine.
struct Processor {
  unsigned number = 0;                                       ///< the system's
  unsigned package = 0, numa_node = 0, cache = 0, core = 0;  ///< `cache`: the last level
  unsigned sibling = 0;                                      ///< its place within the core
};

/// The processors that this process may use, in the order of the topology.
struct Machine {
  std::vector<Processor> processors;
  bool knows_caches = false;  ///< hwloc has found last-level caches (L3)
};

/// Asks hwloc. Throws std::runtime_error where it cannot read the machine.
Machine survey_machine();

struct Placement {
  std::vector<unsigned>
      processors;    ///< numbers; thread i runs on i modulo their count; may be none
  std::string text;  ///< the policy, and what this machine makes of it
};

/// The policies: name and what it does.
struct Policy {
  std::string_view name, summary;
};
std::span<const Policy> policies();

/// Throws UsageError for an unknown policy, with the nearest.
Placement place(std::string_view policy, const Machine& machine);

/// Binds the calling thread. Returns why it cannot; empty if it could.
std::string bind_to(unsigned processor);

}  // namespace irt::contention
