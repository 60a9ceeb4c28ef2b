/// Hardware events that the kernel has no name of its own for, by those of libpfm: which cache a
/// load was served by, and whether another core had changed the line (HITM).
///
/// Processors call them differently, and not every one has each; every figure has a list of names,
/// of which the first that the processor knows is counted.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/contention/hardware_counters.hpp"

namespace irt::contention {

/// A figure and the events it is taken from.
struct NamedEvent {
  std::string_view figure;
  std::span<const char* const> names;  ///< as libpfm writes them, from newer processors to older
};
/// l1_misses, l2_misses, l3_misses, hitm, remote_hitm, other_ccx_fills.
std::span<const NamedEvent> named_events();

/// What perf_event_open(2) wants for `event`; nothing where the processor has none of its names.
/// `pmu` is libpfm's name of a processor, as skx; empty for the one that is here. Of another than
/// that libpfm speaks only with LIBPFM_ENCODE_INACTIVE=1 in the environment.
std::optional<HardwareEvent> encode(const NamedEvent& event, const std::string& pmu = "");

/// Those of this processor.
struct EventsByName {
  std::vector<HardwareEvent> events;
  std::string missing;  ///< why there are none, one line; empty where there are
};
EventsByName events_by_name();

}  // namespace irt::contention
