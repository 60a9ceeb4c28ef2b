/// From simulated runs with several seeds to the figures that are reported.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "bench/many_core/workloads/point.hpp"

namespace irt::many_core {

/// One run object, in the form of all tools, from what `simulate` returned for each seed; `results`
/// has at least one. Where one of them is not "ok" the run is not.
nlohmann::ordered_json summarise(const Profile& profile, const Point& point,
                                 std::span<const nlohmann::json> results);

/// As a run object has them: the levels of `levels`.
nlohmann::ordered_json levels_of(const Profile& profile, Placement placement);

/// What a figure of this kind of queue may be off by: see docs/simulator.md.
std::string band_of(const Point& point);

/// The runs as a table, and as comma-separated values.
std::string table(const nlohmann::ordered_json& runs);
std::string csv(const nlohmann::ordered_json& runs);

/// The hottest lines of a run, as text; empty if it has none.
std::string hot_lines_text(const nlohmann::ordered_json& run);

}  // namespace irt::many_core
