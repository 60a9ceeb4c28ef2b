/// An execution as a reader can follow it.
#pragma once

#include <optional>
#include <vector>

#include "stress/checker/graph.hpp"

namespace irt::checker {

/// The events of the graph, but for what was there before, in an order in which each read finds
/// what was stored last: that of one interleaving of the threads. None if there is no such order,
/// for the execution is one of weak memory only. Of several, that which is nearest to the order in
/// which the events were made.
std::optional<std::vector<EventId>> interleaving(const Graph& graph);

}  // namespace irt::checker
