/// The runs as tables.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/report/results.hpp"

namespace irt::report {

/// An array of tables: {title, columns, rows}. A cell is a number, a string, or null where nothing
/// was measured; rows of runs that did not end well have their status last. The environments are
/// the last table.
nlohmann::ordered_json tables_of(const Results& results);

}  // namespace irt::report
