/// The queues of a probe, by name.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "queues/work_queue.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// What the module's `irt_probe_entries` tells of the queue `name`. Throws std::invalid_argument if
/// there is none of that name.
inline const QueueEntry& probe_entry(virtual_cores::Module& module, std::string_view name) {
  unsigned count = 0;
  const auto* entries = module.function<const QueueEntry*(unsigned*)>("irt_probe_entries")(&count);
  const auto* found = std::find_if(entries, entries + count,
                                   [name](const QueueEntry& entry) { return entry.name == name; });
  if (found == entries + count)
    throw std::invalid_argument("the probe has no queue " + std::string(name));
  return *found;
}

}  // namespace irt::checker
