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
  std::filesystem::path json;
};

/// Pairs the runs of two results that differ in nothing but what is compared, and says for each
/// pair whether the second is faster. Returns 0. Throws UsageError.
int compare(const CompareOptions& options);

/// The comparisons themselves, an object for each pair: what is compared, `ratio` of the medians
/// with `ratio_low` and `ratio_high`, `p` and `verdict`.
nlohmann::ordered_json compare_runs(const nlohmann::json& before, const nlohmann::json& after,
                                    const std::vector<std::string>& queues);

}  // namespace irt::contention
