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

constexpr Cast all(unsigned threads) {
  return {threads, threads, threads};
}
constexpr Cast halves(unsigned threads) {
  return {threads, threads - threads / 2, threads / 2};
}
constexpr Cast to_one(unsigned threads) {
  return {threads, threads - 1, 1};
}
constexpr Cast from_one(unsigned threads) {
  return {threads, 1, threads - 1};
}
constexpr Cast few_producers(unsigned threads) {
  const unsigned producers = std::max(threads / 4, 1U);
  return {threads, producers, threads - producers};
}
// A thread that is left over would have nobody to play with.
constexpr Cast couples(unsigned threads) {
  return {threads - threads % 2, threads / 2, threads / 2};
}

constexpr Scenario sides{.name = "producers-consumers",
                         .operation_mix = "producers push, consumers pop",
                         .program = Program::sides,
                         .cast = halves,
                         .least_threads = 2};

constexpr std::array table{
    Scenario{.name = "pairs",
             .operation_mix = "each thread pushes one, then pops one",
             .program = Program::pairs,
             .cast = all},
    sides,
    Scenario{.name = "fan-in",
             .operation_mix = "all push, one pops",
             .program = Program::sides,
             .cast = to_one,
             .least_threads = 2},
    Scenario{.name = "fan-out",
             .operation_mix = "one pushes, all others pop",
             .program = Program::sides,
             .cast = from_one,
             .least_threads = 2},
    Scenario{.name = "near-empty",
             .operation_mix = "a quarter push, with 1 us more between pushes; the others pop",
             .program = Program::sides,
             .cast = few_producers,
             .least_threads = 2,
             .producer_pause_ns = 1000},
    Scenario{.name = "prefilled",
             .operation_mix = "each thread pops one, then pushes one; the queue is half full",
             .program = Program::exchange,
             .cast = all,
             .prefill = 0.5},
    Scenario{.name = "bursts",
             .operation_mix = "each thread pushes 64, then pops 64",
             .program = Program::bursts,
             .cast = all},
    Scenario{.name = "ping-pong",
             .operation_mix = "couples pass one element to and fro over two queues",
             .program = Program::ping_pong,
             .cast = couples,
             .least_threads = 2},
    Scenario{.name = "renderer",
             .operation_mix = "frames of 64 tasks per thread; a task leads to 6 more on average",
             .program = Program::frames,
             .cast = all},
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
            .fixed = Cast{producers + consumers, producers, consumers}};
  }
  std::vector<std::string_view> names;
  names.reserve(std::size(table) + 1);
  for (const Scenario& scenario : table) names.push_back(scenario.name);
  names.emplace_back("NxM");
  throw UsageError(unknown_name("scenario", name, names));
}

std::string obstacle(const Cast& cast, const Claims& claims) {
  const bool own =
      claims.producers == Callers::own_worker || claims.consumers == Callers::own_worker;
  if (own && !cast.together()) return "a worker pops only what it pushed itself";
  if (!claims.allows_workers(cast.threads))
    return fmt::format("it is for at most {} workers", claims.max_workers);
  constexpr std::uint64_t bits_of_elements = (std::uint64_t{1} << 56U) - 1;
  if ((claims.unused_bits & bits_of_elements) != 0)
    return "its elements leave bits unused that the elements here need";
  if (claims.producers == Callers::one && cast.producers > 1) return "it allows one producer";
  if (claims.consumers == Callers::one && cast.consumers > 1) return "it allows one consumer";
  return {};
}

}  // namespace irt::contention
