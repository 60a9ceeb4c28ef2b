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
  Pass pass = Pass::plain;
  Sample sample;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Result, row, repetition, pass, sample)

/// What was measured once for the whole sweep.
struct Calibration {
  Pace pace;              ///< of busy waits
  double harness_ns = 0;  ///< processor time per operation of the loop without a queue
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Calibration, pace, harness_ns)

/// One run for each row that has results. docs/contention.md says what each figure means.
nlohmann::ordered_json summarise(const Plan& plan, std::span<const Row> rows,
                                 std::span<const Result> results, const Calibration& calibration,
                                 const nlohmann::json& conditions);

/// The same from a journal: its header ("plan", "rows", "calibration", "conditions") and its lines,
/// a `Result` each. Throws nlohmann::json::exception where a field is missing or of another type,
/// std::out_of_range where a result is of no row.
nlohmann::ordered_json summarise_journal(const nlohmann::json& header,
                                         std::span<const nlohmann::json> lines);
inline constexpr const char* journal_format = "irt-contention 2";

/// For people.
std::string table(const nlohmann::ordered_json& runs);

}  // namespace irt::contention
