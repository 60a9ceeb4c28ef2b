/// The kill matrix: which instrument finds which mutant, and how soon.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/history/clock.hpp"
#include "stress/mutants/mutants.hpp"

namespace irt::stress {

struct KillOptions {
  std::vector<std::string> ids;  ///< mutants by id, which exist; empty for all
  unsigned runs = 1;             ///< of each mutant
  double seconds = 10;           ///< for each run, and a tenth of it for the twin
  std::uint64_t seed = 1;
  std::vector<std::string> merge;  ///< results (JSON) of builds with other sanitizers
  std::string json;                ///< write the results here
};

/// Runs the mutants that this build's instrument should see, and all twins; prints the matrix.
/// Returns whether every such mutant was killed in every run and no twin was accused.
/// Throws std::runtime_error for files that cannot be read or written.
bool kill_mutants(const KillOptions& options, const ClockQuality& clock);

}  // namespace irt::stress
