/// What every chart should have beside the queues.
#pragma once

#include <string>
#include <vector>

#include "queues/registry.hpp"

namespace irt {

/// The counters that carry no elements (the ceiling, and the work alone), and the null hypothesis:
/// a deque under a mutex.
inline std::vector<std::string> baseline_queues() {
  std::vector<std::string> names;
  for (const QueueEntry& counter : built_in_counters()) names.emplace_back(counter.name);
  names.emplace_back("mutex");
  return names;
}

}  // namespace irt
