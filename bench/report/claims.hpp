/// What queues claim, in words.
#pragma once

#include <nlohmann/json.hpp>

#include "queues/work_queue.hpp"

namespace irt {

/// {ordering, push, pop, bound, reclamation}, as results hold it under `claims`.
nlohmann::ordered_json claims_for_report(const Claims& claims);

}  // namespace irt
