/// The claims of a queue in words, for results.
#pragma once

#include <nlohmann/json.hpp>

#include "queues/work_queue.hpp"

namespace irt {

/// {"ordering", "push", "pop", "bound", "reclamation"}, each a few words.
nlohmann::ordered_json claims_in_words(const Claims& claims);

}  // namespace irt
