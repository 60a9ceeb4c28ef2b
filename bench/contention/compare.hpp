/// `irt bench compare`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace irt::contention {

struct CompareOptions {
  std::vector<std::filesystem::path> files;  ///< two, or one with `queues`
  std::vector<std::string> queues;  ///< two: the first of the first file against the second
  bool per_cpu_second = false;      ///< compare operations per second of processor time
  std::filesystem::path json;
};

/// Pairs the runs of two results that differ in nothing but what is compared, and says for each
/// pair whether the second is faster. Returns 0. Throws UsageError.
int compare(const CompareOptions& options);

/// The comparisons themselves, an object for each pair: what is compared, `test`, `ratio` with
/// `ratio_low` and `ratio_high`, `p` and `verdict`. Two runs of one sweep (the same conditions at
/// the same time, the same seed) with at least `fewest_pairs` rounds in common are compared round
/// by round, "signed-rank"; others as two sets, "mann-whitney".
nlohmann::ordered_json compare_runs(const nlohmann::json& before, const nlohmann::json& after,
                                    const std::vector<std::string>& queues);

}  // namespace irt::contention
