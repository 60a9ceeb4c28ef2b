/// `irt check --scenario`: a scenario of real threads on virtual cores, sampled.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "stress/checker/queue_check.hpp"
#include "stress/scenarios/scenarios.hpp"

namespace irt::checker {

/// The scenario `name` if the queue can be used so on virtual cores. Throws UsageError with those
/// that can be.
const stress::Scenario& scenario_at(const std::string& name, const QueueEntry& entry);

/// Samples `scenario` over the queue in `module`, in rounds with seeds from that of `settings` on,
/// until a round finds something or the time is up. Rounds differ in operations, capacity, random
/// numbers and the search (pos, pct, random in turn, unless `settings` name one); each makes a
/// fixed number of executions, so that what is found does not depend on the machine or on the jobs.
/// `command` is how to call the tool again for this queue and scenario.
ShapeResult sample_scenario(const QueueEntry& entry, virtual_cores::Module& module,
                            const stress::Scenario& scenario, const CheckSettings& settings,
                            const std::string& command);

/// The report of what `schedule` does in the round of the seed of `settings`; empty if it finds
/// nothing.
std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const stress::Scenario& scenario, const CheckSettings& settings,
                   const std::string& schedule, const std::string& dot_file);

}  // namespace irt::checker
