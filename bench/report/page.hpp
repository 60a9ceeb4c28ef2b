/// The report as one HTML file that needs nothing else.
#pragma once

#include <span>
#include <string>

#include "bench/report/figures.hpp"
#include "bench/report/results.hpp"

namespace irt::report {

/// The page: markup, style, script and data in one text. Whatever strings the results hold are
/// data to it, never markup.
std::string page_of(const Results& results, std::span<const Panel> panels);

}  // namespace irt::report
