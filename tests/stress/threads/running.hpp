/// Runs a suite on a queue in a child process, as the tool does.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "stress/threads/child.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {

using Suite = std::function<void(const Assignment&, Messenger&)>;

inline Result run(const QueueEntry& entry, double seconds, const Suite& suite) {
  static const ClockQuality clock = calibrate();
  const Assignment assignment{entry, clock, seconds, 1, "repeat"};
  Result result;
  result.queue = entry.name;
  run_in_child(
      result, seconds, 30, [&](Messenger& messenger) { suite(assignment, messenger); },
      [](std::uint64_t) {});
  return result;
}

inline Result run_on(const QueueEntry& entry, std::string_view scenario, double seconds = 0.5) {
  return run(entry, seconds, [&](const Assignment& a, Messenger& m) {
    run_scenario(a, *find_scenario(scenario), m);
  });
}

inline std::string claim_of(const Result& result) {
  return result.findings.empty() ? "nothing" : result.findings[0].claim;
}

}  // namespace irt::stress
