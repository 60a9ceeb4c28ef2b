/// The lines that cores fight over most, by the source lines that want them: what `perf c2c` shows
/// of a machine that is there.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/many_core/machine/machine.hpp"

namespace irt::many_core {

/// The lines of most waiting, at most eight. Each has `what` (where its memory was allocated, and
/// the line's offset there), `transfers`, `share_of_waiting`, `false_sharing` (share of transfers
/// where the core wanted no byte that others had used) and `sites` (place, source, requests,
/// share_of_waiting, writes).
nlohmann::json hot_lines(const Machine& machine, const virtual_cores::Module& module);

}  // namespace irt::many_core
