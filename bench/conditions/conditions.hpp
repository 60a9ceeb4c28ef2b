/// Under which conditions a figure came about, as every tool writes it beside its results.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace irt {

/// Machine, system and build as one flat object, with `pinning` as given ("none", or how threads
/// were bound). What the system does not tell is null. Reads files for some milliseconds: call it
/// once, before measuring.
///
/// Keys: time (ISO 8601, UTC), cpu, packages, numa_nodes, cores, hardware_threads, memory_bytes,
/// hypervisor, governor, turbo, cpu_limit (processors), transparent_huge_pages, load_average,
/// kernel, compiler, flags, build_type, commit, pinning.
nlohmann::json conditions(std::string_view pinning = "none");

/// Of all conditions, those that make figures incomparable when they change.
nlohmann::json lasting_conditions(const nlohmann::json& conditions);

/// Who gives this process memory: glibc with its version, and what was loaded before it.
std::string allocator();

}  // namespace irt
