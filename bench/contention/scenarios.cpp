#include "bench/contention/scenarios.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <vector>

#include "queues/nearest.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

constexpr Roles halves(unsigned threads) {
  return apart(threads - threads / 2, threads / 2);
}
constexpr Roles to_one(unsigned threads) {
  return apart(threads - 1, 1);
}
constexpr Roles from_one(unsigned threads) {
  return apart(1, threads - 1);
}
constexpr Roles few_producers(unsigned threads) {
  const unsigned producers = std::max(threads / 4, 1U);
  return apart(producers, threads - producers);
}
// A thread that is left over would have nobody to play with.
constexpr Roles couples(unsigned threads) {
  return apart(threads / 2, threads / 2);
}

constexpr Scenario sides{.name = "producers-consumers",
                         .operation_mix = "producers push, consumers pop",
                         .program = Program::sides,
                         .roles = halves,
                         .least_threads = 2};

constexpr std::array table{
    Scenario{.name = "pairs",
             .operation_mix = "each thread pushes one, then pops one",
             .program = Program::pairs,
             .roles = all_do_both},
    sides,
    Scenario{.name = "fan-in",
             .operation_mix = "all push, one pops",
             .program = Program::sides,
             .roles = to_one,
             .least_threads = 2},
    Scenario{.name = "fan-out",
             .operation_mix = "one pushes, all others pop",
             .program = Program::sides,
             .roles = from_one,
             .least_threads = 2},
    Scenario{.name = "near-empty",
             .operation_mix = "a quarter push, with 1 us more between pushes; the others pop",
             .program = Program::sides,
             .roles = few_producers,
             .least_threads = 2,
             .producer_pause_ns = 1000},
    Scenario{.name = "prefilled",
             .operation_mix = "each thread pops one, then pushes one; the queue is half full",
             .program = Program::exchange,
             .roles = all_do_both,
             .prefill = 0.5},
    Scenario{.name = "bursts",
             .operation_mix = "each thread pushes 64, then pops 64",
             .program = Program::bursts,
             .roles = all_do_both},
    Scenario{.name = "ping-pong",
             .operation_mix = "couples pass one element to and fro over two queues",
             .program = Program::ping_pong,
             .roles = couples,
             .least_threads = 2},
    Scenario{.name = "renderer",
             .operation_mix = "frames of 64 tasks per thread; a task leads to 6 more on average",
             .program = Program::frames,
             .roles = all_do_both},
};

}  // namespace

std::span<const Scenario> scenarios() {
  return table;
}

std::string Chosen::name() const {
  return fixed ? fmt::format("{}x{}", fixed->producers, fixed->consumers)
               : std::string(scenario->name);
}

Chosen scenario_at(const std::string& name) {
  const auto* found = std::ranges::find(table, name, &Scenario::name);
  if (found != table.end()) return {.scenario = found, .fixed = {}};
  unsigned producers = 0, consumers = 0;
  char rest = 0;
  // NOLINTNEXTLINE(cert-err34-c): five digits fit
  if (std::sscanf(name.c_str(), "%5ux%5u%c", &producers, &consumers, &rest) == 2) {
    if (producers == 0 || consumers == 0 || producers + consumers > most_threads) {
      throw UsageError(fmt::format("--scenario {}: of both at least one, and together at most {}",
                                   name, most_threads));
    }
    return {.scenario = &*std::ranges::find(table, Program::sides, &Scenario::program),
            .fixed = apart(producers, consumers)};
  }
  std::vector<std::string_view> names;
  names.reserve(std::size(table) + 1);
  for (const Scenario& scenario : table) names.push_back(scenario.name);
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
