#include "bench/conditions/conditions.hpp"

#include <array>
#include <cstdlib>
#include <ctime>
#include <gnu/libc-version.h>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/conditions/build_info.hpp"
#include "bench/conditions/system.hpp"
#include "bench/conditions/topology.hpp"

namespace irt {
namespace {

nlohmann::json or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

template <class T>
nlohmann::json or_null(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

std::string now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

}  // namespace

nlohmann::json conditions(std::string_view pinning) {
  const Topology topology = survey_topology();
  const System system = survey_system();
  nlohmann::json hypervisor;
  if (system.virtual_machine) {
    hypervisor = system.hypervisor.empty() ? "unnamed" : system.hypervisor;
  }
  return {
      {"time", now()},
      {"cpu", or_null(system.cpu_model)},
      {"packages", topology.packages},
      {"numa_nodes", topology.numa_nodes},
      {"cores", topology.cores},
      {"hardware_threads", topology.hardware_threads},
      {"memory_bytes", system.memory_bytes},
      {"hypervisor", hypervisor},
      {"governor", or_null(system.governor)},
      {"turbo", or_null(system.turbo)},
      {"cpu_limit", or_null(system.cpu_limit)},
      {"transparent_huge_pages", or_null(system.transparent_huge_pages)},
      {"load_average", system.load_average},
      {"kernel", or_null(system.kernel)},
      {"compiler", build_compiler},
      {"flags", build_flags},
      {"build_type", build_type},
      {"commit", build_commit},
      {"pinning", pinning},
  };
}

nlohmann::json lasting_conditions(const nlohmann::json& conditions) {
  nlohmann::json kept;
  for (const char* name :
       {"cpu", "packages", "numa_nodes", "cores", "hardware_threads", "governor", "turbo",
        "cpu_limit", "kernel", "compiler", "flags", "build_type", "commit", "pinning"}) {
    if (conditions.contains(name)) kept[name] = conditions[name];
  }
  return kept;
}

std::string allocator() {
  std::string text = std::string("glibc ") + gnu_get_libc_version();
  if (const char* preloaded = std::getenv("LD_PRELOAD")) {
    text += std::string(", preloaded: ") + preloaded;
  }
  return text;
}

}  // namespace irt
