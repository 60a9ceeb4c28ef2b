/// `irt bench contention`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/contention/plan.hpp"

namespace irt::contention {

struct SweepOptions {
  Plan plan;
  bool resume = false;
  std::filesystem::path out = "irt-out", json;
  std::vector<std::string> given;  ///< the fields of the plan that the user did set
};

/// Measures the plan, repetition by repetition, each result kept in `out`/contention.jsonl as it
/// comes; then writes the figures to `out`/contention.json, `json` and standard output. `program`
/// is what is started for each repetition. Returns 1 where a queue hung, crashed or failed. Throws
/// UsageError or RegistryError.
int sweep(const SweepOptions& options, QueueRegistry& queues, const std::filesystem::path& program);

}  // namespace irt::contention
