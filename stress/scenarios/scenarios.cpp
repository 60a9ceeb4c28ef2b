#include "stress/scenarios/scenarios.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "stress/scenarios/bodies.hpp"
#include "stress/scenarios/core_hand.hpp"

namespace irt::stress {
namespace {

// Name, what it does, pushers, poppers, together, capacity, generations, program.
constexpr std::array all{
    Scenario{"spsc", "one producer, one consumer", 1, 1, false, 64, 1, mix},
    Scenario{"mpsc", "three producers, one consumer", 3, 1, false, 64, 1, mix},
    Scenario{"spmc", "one producer, three consumers", 1, 3, false, 64, 1, mix},
    Scenario{"mpmc", "two producers, two consumers", 2, 2, false, 64, 1, mix},
    Scenario{"eight-to-one", "eight producers, one consumer", 8, 1, false, 256, 1, mix},
    Scenario{"one-to-eight", "one producer, eight consumers", 1, 8, false, 256, 1, mix},
    Scenario{"crowd", "eight producers, eight consumers: more threads than cores", 8, 8, false, 256,
             1, mix},
    Scenario{"bursts", "producers push many at once, consumers empty the queue", 2, 2, false, 512,
             1, bursts},
    Scenario{"ping-pong", "each worker pushes one and takes one", 2, 2, true, 64, 1, ping_pong},
    Scenario{"near-empty", "rare pushes, many failing pops", 1, 3, false, 64, 1, near_empty},
    Scenario{"full-ring", "pushes against a full queue, slow pops", 3, 1, false, 4, 1, full_ring},
    Scenario{"tiny", "a capacity of one: rings and segments wrap all the time", 2, 2, false, 1, 1,
             mix},
    Scenario{"roles", "workers that push for a while, then pop for a while", 3, 3, true, 128, 1,
             roles},
    Scenario{"come-and-go", "short-lived threads, one after the other, for every worker", 2, 2,
             false, 64, 12, mix},
    Scenario{"renderer", "workers pop a task and push up to six, frame after frame", 3, 3, true,
             4096, 1, renderer},
    Scenario{"built-and-dropped", "other queues are built and dropped, full, beside the one in use",
             2, 2, true, 64, 1, built_and_dropped},
    Scenario{.name = "left-inside",
             .summary = "more pushes than pops, and the queue is destroyed with what is left",
             .capacity = 64,
             .run = left_inside,
             .drains = false,
             .leaves_inside = true},
    Scenario{.name = "bulk",
             .summary = "several elements in a call",
             .capacity = 32,
             .run = bulk,
             .needs = {.bulk = true}},
    Scenario{.name = "parked",
             .summary = "two producers, three consumers who wait",
             .poppers = 3,
             .capacity = 64,
             .run = parked,
             .needs = {.pop_wait = true}},
    Scenario{.name = "parked-tiny",
             .summary = "the same with one consumer more than places",
             .poppers = 3,
             .capacity = 2,
             .run = parked,
             .needs = {.pop_wait = true}},
    Scenario{.name = "parked-closed-early",
             .summary = "the queue is closed while producers push and consumers wait",
             .poppers = 3,
             .capacity = 8,
             .run = parked_closed_early,
             .needs = {.pop_wait = true}},
    Scenario{.name = "parked-for-a-while",
             .summary = "consumers wait until deadlines, some of which have passed",
             .poppers = 3,
             .capacity = 16,
             .run = parked_for_a_while,
             .needs = {.pop_wait = true, .deadline = true}},
};

}  // namespace

Roles roles_for(const Scenario& scenario, const Claims& claims) {
  return roles_within(claims, scenario.together ? all_do_both(scenario.pushers)
                                                : apart(scenario.pushers, scenario.poppers));
}

bool allows(const Methods& methods, const Claims& claims, const Scenario& scenario) {
  const Methods& needs = scenario.needs;
  if ((needs.pop_wait && !methods.pop_wait) || (needs.deadline && !methods.deadline) ||
      (needs.bulk && !methods.bulk))
    return false;
  // Who waits for others must not be the one who pushes.
  return !needs.pop_wait || !roles_for(scenario, claims).together();
}

std::span<const Scenario> scenarios() {
  return all;
}

namespace {

/// The program of the contention scenario with this number in its table.
template <std::size_t number>
void contend(Core& core) {
  constexpr const contention::Scenario& scenario = contention::scenario_table[number];
  if constexpr (scenario.prefill > 0) {
    const WorkerState& self = core.self();
    const double share = scenario.prefill * static_cast<double>(self.capacity) / self.workers;
    for (auto left = std::min(static_cast<std::uint64_t>(share) + 1, self.operations / 2); left > 0;
         --left)
      core.push();
    core.meet();
  }
  contention::play<CoreHand>(scenario.program, core, &core);
}

template <std::size_t... numbers>
std::vector<Scenario> contention_table(std::index_sequence<numbers...>) {
  constexpr unsigned threads = 4;
  static const std::array<std::string, sizeof...(numbers)> names{
      "contention/" + std::string(contention::scenario_table[numbers].name)...};
  std::vector<Scenario> table;
  const auto add = [&](std::size_t number, void (*program)(Core&)) {
    const contention::Scenario& scenario = contention::scenario_table[number];
    if (scenario.has_two_queues()) return;
    const Roles roles = scenario.roles(threads);
    table.push_back({.name = names[number],
                     .summary = scenario.operation_mix,
                     .pushers = roles.producers,
                     .poppers = roles.consumers,
                     .together = roles.together(),
                     .capacity = 64,
                     .run = program,
                     .needs = {.bulk = scenario.needs_bulk()}});
  };
  (add(numbers, contend<numbers>), ...);
  return table;
}

}  // namespace

std::span<const Scenario> contention_scenarios() {
  static const std::vector<Scenario> table =
      contention_table(std::make_index_sequence<contention::scenario_table.size()>{});
  return table;
}

const Scenario* find_scenario(std::string_view name) {
  for (const std::span<const Scenario> kind : {scenarios(), contention_scenarios()}) {
    for (const Scenario& scenario : kind)
      if (scenario.name == name) return &scenario;
  }
  return nullptr;
}

}  // namespace irt::stress
