/// What a stalled thread does to the others: one is stopped before each of its steps in turn, and
/// the rest must come to an end and get out what was put in.
///
/// A lock-free queue passes whatever is stopped where. A queue that is not cannot be shown to be
/// blocking by passing, only by failing: the schedules around the stop are sampled.
#pragma once

#include <functional>

#include "stress/checker/checker.hpp"

namespace irt::checker {

struct ProgressResult {
  std::optional<Finding> finding;
  std::vector<Step> steps;
  unsigned thread = 0;      ///< that was stopped
  std::size_t stopped = 0;  ///< before this step of its own
  std::uint64_t executions = 0;
  bool finished = false;     ///< each thread was stopped before each of its steps
  std::string incomplete{};  ///< a limit that was reached, see Result
  const void* incomplete_at = nullptr;
};

/// Stops each thread before each of its steps, with `schedules` random schedules for each, until
/// `seconds` are over. `look` gets the execution with the finding, if there is one.
ProgressResult check_progress(const Program& program, const Limits& limits, std::uint64_t seed,
                              unsigned schedules, double seconds,
                              const std::function<void(const Execution&)>& look = {});

}  // namespace irt::checker
