/// Who pushes and pops what. One file per scenario, one line here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "queues/roles.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::stress {

/// A pattern of use. `run` is the program of every worker; it asks `Core::self()` for its part and
/// works until `Core::more()` ends.
struct Scenario {
  std::string_view name;
  std::string_view summary;
  /// How many workers push and how many pop, when the queue allows several.
  unsigned pushers = 2;
  unsigned poppers = 2;
  bool together = false;       ///< every worker does both; `pushers` of them
  std::size_t capacity = 256;  ///< the queue's capacity hint
  unsigned generations = 1;    ///< threads that follow each other in the role of each worker
  void (*run)(Core& core) = nullptr;
  bool drains = true;          ///< what is left is popped at the end
  bool leaves_inside = false;  ///< the queue is destroyed with what is left
  Methods needs{};             ///< optional methods that it calls
};

/// Whether a queue with these optional methods and claims can be used as `scenario` does.
bool allows(const Methods& methods, const Claims& claims, const Scenario& scenario);

/// Who pushes and pops in `scenario` when a queue has these claims.
Roles roles_for(const Scenario& scenario, const Claims& claims);

/// All scenarios.
std::span<const Scenario> scenarios();

/// The contention scenarios (contention.hpp) of one queue:
/// as "contention/pairs", for four workers. They are run where they are named.
std::span<const Scenario> contention_scenarios();

/// The scenario `name` of any kind, or null.
const Scenario* find_scenario(std::string_view name);

}  // namespace irt::stress
