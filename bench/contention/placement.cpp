#include "bench/contention/placement.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <pthread.h>
#include <sched.h>
#include <set>
#include <system_error>

#include "bench/conditions/hwloc.hpp"
#include "queues/nearest.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

constexpr std::array policy_table{
    Policy{"close", "cores under one last-level cache first, then their siblings, then the next"},
    Policy{"far", "as far apart as possible: packages, then caches, then cores, then siblings"},
    Policy{"one-per-l3", "one thread under each last-level cache, then a second one under each"},
    Policy{"smt-first", "the hardware threads of one core first, then the next core"},
    Policy{"smt-last", "every core once, then their second hardware threads"},
    Policy{"numa-spread", "one thread on each NUMA node, then a second one on each"},
    Policy{"none", "wherever the system puts them"},
};

/// The place of each processor within its group, when groups are filled core by core and siblings
/// come last.
std::vector<unsigned> ranks(const std::vector<Processor>& processors, unsigned Processor::*group) {
  std::vector<unsigned> order(processors.size());
  for (unsigned i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](unsigned i) { return processors[i].sibling; });
  std::map<unsigned, unsigned> filled;
  std::vector<unsigned> rank(processors.size());
  for (const unsigned i : order) rank[i] = filled[processors[i].*group]++;
  return rank;
}

/// The place of each group among those of the larger group it belongs to.
std::map<unsigned, unsigned> places(const std::vector<Processor>& processors,
                                    unsigned Processor::*group, unsigned Processor::*larger) {
  std::map<unsigned, unsigned> seen, place;
  for (const Processor& one : processors) {
    if (!place.contains(one.*group)) place[one.*group] = seen[one.*larger]++;
  }
  return place;
}

using Key = std::array<unsigned, 4>;  // the smallest comes first

std::vector<Key> keys(std::string_view policy, const std::vector<Processor>& processors) {
  std::vector<Key> all;
  const auto in_cache = ranks(processors, &Processor::cache);
  const auto in_node = ranks(processors, &Processor::numa_node);
  auto cache_place = places(processors, &Processor::cache, &Processor::package);
  for (std::size_t i = 0; i < processors.size(); ++i) {
    const Processor& one = processors[i];
    if (policy == "close") all.push_back({one.package, one.cache, one.sibling, one.core});
    if (policy == "far") all.push_back({in_cache[i], cache_place[one.cache], one.package, 0});
    if (policy == "one-per-l3") all.push_back({in_cache[i], one.cache, 0, 0});
    if (policy == "smt-first") all.push_back({one.core, one.sibling, 0, 0});
    if (policy == "smt-last") all.push_back({one.sibling, one.core, 0, 0});
    if (policy == "numa-spread") all.push_back({in_node[i], one.numa_node, 0, 0});
  }
  return all;
}

std::size_t distinct(const std::vector<Processor>& processors, unsigned Processor::*group) {
  std::set<unsigned> groups;
  for (const Processor& one : processors) groups.insert(one.*group);
  return groups.size();
}

/// What the machine lacks for the policy to mean what it says.
std::string lack(std::string_view policy, const Machine& machine) {
  const auto& processors = machine.processors;
  if (policy == "one-per-l3" && !machine.knows_caches) return "no L3 is known here: by package";
  if (policy == "one-per-l3" && distinct(processors, &Processor::cache) == 1) return "one L3 here";
  if (policy == "numa-spread" && distinct(processors, &Processor::numa_node) == 1)
    return "one NUMA node here";
  if (policy.starts_with("smt-") && distinct(processors, &Processor::core) == processors.size())
    return "no SMT here";
  if (policy == "far" && distinct(processors, &Processor::cache) == 1) return "one L3 here";
  return {};
}

unsigned number_of(hwloc_topology_t topology, hwloc_obj_type_t type, hwloc_obj_t processor,
                   unsigned otherwise) {
  hwloc_obj_t object = hwloc_get_ancestor_obj_by_type(topology, type, processor);
  return object == nullptr ? otherwise : object->logical_index;
}

}  // namespace

Machine survey_machine() {
  const HwlocTopology loaded = load_hwloc();
  hwloc_topology_t topology = loaded.get();
  const HwlocSet allowed = allowed_processors(topology);
  Machine machine;
  machine.knows_caches = hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_L3CACHE) > 0;
  std::map<unsigned, unsigned> siblings;
  for (hwloc_obj_t object = nullptr;
       (object = hwloc_get_next_obj_by_type(topology, HWLOC_OBJ_PU, object)) != nullptr;) {
    if (hwloc_bitmap_isset(allowed.get(), object->os_index) == 0) continue;
    Processor one{.number = object->os_index};
    one.package = number_of(topology, HWLOC_OBJ_PACKAGE, object, 0);
    one.cache = number_of(topology, HWLOC_OBJ_L3CACHE, object, one.package);
    one.core = number_of(topology, HWLOC_OBJ_CORE, object, object->logical_index);
    const int node = hwloc_bitmap_first(object->nodeset);
    one.numa_node = node < 0 ? 0 : static_cast<unsigned>(node);
    one.sibling = siblings[one.core]++;
    machine.processors.push_back(one);
  }
  return machine;
}

std::span<const Policy> policies() {
  return policy_table;
}

Placement place(std::string_view policy, const Machine& machine) {
  std::vector<std::string_view> names;
  names.reserve(std::size(policy_table));
  for (const Policy& one : policy_table) names.push_back(one.name);
  if (std::ranges::find(names, policy) == names.end()) {
    throw UsageError(unknown_name("placement", policy, names));
  }
  Placement placement{.processors = {}, .text = std::string(policy)};
  if (policy == "none") return placement;
  const std::vector<Key> order = keys(policy, machine.processors);
  std::vector<unsigned> indices(order.size());
  for (unsigned i = 0; i < indices.size(); ++i) indices[i] = i;
  std::ranges::stable_sort(indices, {}, [&](unsigned i) { return order[i]; });
  for (const unsigned i : indices) placement.processors.push_back(machine.processors[i].number);
  if (const std::string why = lack(policy, machine); !why.empty()) {
    placement.text += fmt::format(" ({})", why);
  }
  return placement;
}

std::string bind_to(unsigned processor) {
  const std::size_t bytes = CPU_ALLOC_SIZE(processor + 1);
  const std::unique_ptr<cpu_set_t, void (*)(cpu_set_t*)> set(CPU_ALLOC(processor + 1),
                                                             [](cpu_set_t* s) { CPU_FREE(s); });
  CPU_ZERO_S(bytes, set.get());
  CPU_SET_S(processor, bytes, set.get());
  const int error = pthread_setaffinity_np(pthread_self(), bytes, set.get());
  return error == 0 ? "" : std::generic_category().message(error);
}

}  // namespace irt::contention
