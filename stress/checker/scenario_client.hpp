/// A client of one queue: a scenario of `stress/scenarios`, the same that real threads run, with
/// few operations, judged by the same oracles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "queues/roles.hpp"
#include "stress/checker/checker.hpp"
#include "stress/checker/queue_calls.hpp"
#include "stress/checker/virtual_core.hpp"
#include "stress/scenarios/scenarios.hpp"

namespace irt::checker {

/// One round of a scenario: how many operations, on which capacity, with which random numbers. All
/// of it follows from the seed, and is the same in every execution.
class ScenarioClient {
 public:
  /// `capacity` of the queue, in elements; 0: drawn. Where the queue claims something of real time,
  /// calls are ordered by a clock too with `real_time`; none: drawn. Each worker of the scenario is
  /// one thread: `generations` is not asked.
  ScenarioClient(const QueueEntry& entry, const stress::Scenario& scenario, std::uint64_t seed,
                 std::size_t capacity, std::optional<bool> real_time,
                 virtual_cores::Module* module);
  ScenarioClient(const ScenarioClient&) = delete;
  ScenarioClient& operator=(const ScenarioClient&) = delete;

  [[nodiscard]] const Program& program() const { return program_; }
  /// The calls of the last execution.
  [[nodiscard]] std::vector<QueueCall> operations() const;
  /// "4 workers with 5 operations each, capacity 2".
  [[nodiscard]] std::string description() const;

 private:
  void prepare();
  void run(unsigned worker);
  void finish();
  [[nodiscard]] std::optional<std::string> judge() const;

  QueueEntry entry_;
  stress::Scenario scenario_;
  std::uint64_t seed_;
  std::size_t capacity_;
  std::uint64_t operations_ = 0;
  Claims claims_;  ///< by which the history is judged
  Roles roles_;
  Program program_;
  stress::ElementQueue* queue_ = nullptr;
  ScenarioRun run_;
  std::vector<stress::WorkerState> states_;
  std::vector<stress::Operation> drain_;
};

}  // namespace irt::checker
