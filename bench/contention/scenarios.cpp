#include "bench/contention/scenarios.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <vector>

#include "queues/nearest.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {

std::span<const Scenario> scenarios() {
  return scenario_table;
}

std::string Chosen::name() const {
  return fixed ? fmt::format("{}x{}", fixed->producers, fixed->consumers)
               : std::string(scenario->name);
}

Chosen scenario_at(const std::string& name) {
  if (const Scenario* found = find_scenario(name)) return {.scenario = found, .fixed = {}};
  unsigned producers = 0, consumers = 0;
  char rest = 0;
  // NOLINTNEXTLINE(cert-err34-c): five digits fit
  if (std::sscanf(name.c_str(), "%5ux%5u%c", &producers, &consumers, &rest) == 2) {
    if (producers == 0 || consumers == 0 || producers + consumers > most_threads) {
      throw UsageError(fmt::format("--scenario {}: of both at least one, and together at most {}",
                                   name, most_threads));
    }
    return {.scenario = find_scenario("producers-consumers"), .fixed = apart(producers, consumers)};
  }
  std::vector<std::string_view> names;
  names.reserve(std::size(scenario_table) + 1);
  for (const Scenario& scenario : scenario_table) names.push_back(scenario.name);
  names.emplace_back("NxM");
  throw UsageError(unknown_name("scenario", name, names));
}

std::string obstacle(const Roles& roles, const Claims& claims) {
  constexpr std::uint64_t bits_of_elements = (std::uint64_t{1} << 56U) - 1;
  if ((claims.unused_bits & bits_of_elements) != 0)
    return "its elements leave bits unused that the elements here need";
  return irt::obstacle(claims, roles);
}

}  // namespace irt::contention
