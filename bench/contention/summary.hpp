/// From repetitions to figures.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/contention/plan.hpp"

namespace irt::contention {

/// A repetition that was measured, as it stands in the journal.
struct Result {
  unsigned row = 0;
  unsigned repetition = 0;
  bool latency = false;
  Sample sample;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Result, row, repetition, latency, sample)

/// What was measured once for the whole sweep.
struct Calibration {
  Pace pace;              ///< of busy waits
  double harness_ns = 0;  ///< processor time per operation of the loop without a queue
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Calibration, pace, harness_ns)

/// One run for each row that has results. docs/contention.md says what each figure means.
nlohmann::ordered_json summarise(const Plan& plan, std::span<const Row> rows,
                                 std::span<const Result> results, const Calibration& calibration,
                                 const QueueRegistry& queues, const nlohmann::json& conditions);

/// For people.
std::string table(const nlohmann::ordered_json& runs);

}  // namespace irt::contention
