/// A trace as a file that chrome://tracing and ui.perfetto.dev open.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "renderer/engine/trace_log.hpp"

namespace irt::frames {

/// Writes the Trace Event Format: an object whose `traceEvents` are complete events (`ph` "X"),
/// times in microseconds from the first span on; each thread's events by their begin. `about` goes
/// to `otherData`, with the number of spans that did not fit. Throws UsageError.
void write_trace(const std::filesystem::path& file, const TraceLog& log, nlohmann::json about);

}  // namespace irt::frames
