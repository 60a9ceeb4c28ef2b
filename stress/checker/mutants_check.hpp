/// The mutants of stress/mutants under the checker: which searches find which, and how soon.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stress/checker/checker.hpp"
#include "stress/mutants/mutants.hpp"

namespace irt::checker {

/// The mutants in a module made from mutants_module.cpp. Valid as long as the module.
std::vector<stress::Mutant> mutants_of(virtual_cores::Module& module);

/// The shapes that a mutant and its twin are tried with. None, for most: they get what every queue
/// gets.
std::vector<std::string> shapes_for(const stress::Mutant& mutant, std::optional<Search> search);

/// What came out of trying one queue.
struct Trial {
  std::optional<FindingKind> found;
  std::string shape;   ///< that showed it
  double seconds = 0;  ///< until then, or in all
  std::uint64_t executions = 0;
  bool finished = true;  ///< every search came to its end
};

/// One search over all `shapes`, at most `seconds` in all. No search: what `irt check`
/// does by default.
Trial try_queue(const QueueEntry& queue, const std::vector<std::string>& shapes,
                virtual_cores::Module& module, std::optional<Search> search, std::uint64_t seed,
                double seconds);

struct KillSettings {
  std::vector<std::string> ids;  ///< empty: all
  unsigned seeds = 3;            ///< of each random search
  double seconds = 60;           ///< for each mutant and search, at most
  bool default_only = false;     ///< only what `irt check` does by default, with each seed
  std::string json = {};         ///< of the default search, as `irt stress --mutants` merges it
};

/// Prints a line for each mutant: the first report of each search, and what its twin did. Returns
/// whether the default search found all mutants and accused no twin. Throws std::invalid_argument
/// for an unknown id, std::runtime_error where `json` cannot be written.
bool kill_matrix(virtual_cores::Module& module, const KillSettings& settings);

}  // namespace irt::checker
