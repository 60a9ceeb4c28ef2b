// In a build without libpfm.
#include "bench/contention/named_events.hpp"

namespace irt::contention {

std::span<const NamedEvent> named_events() {
  return {};
}

std::optional<HardwareEvent> encode(const NamedEvent& /*event*/, const std::string& /*pmu*/) {
  return std::nullopt;
}

EventsByName events_by_name() {
  return {.events = {},
          .missing =
              "hardware counters: L1, L2, L3 misses and HITM are not counted, this build is "
              "without libpfm (libpfm4-dev)"};
}

}  // namespace irt::contention
