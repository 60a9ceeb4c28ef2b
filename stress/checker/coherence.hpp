/// Coherence, [intro.races] of C++20: where in a location's modification order a read may read, and
/// where a store may be put.
#pragma once

#include <cstddef>
#include <optional>

#include "stress/checker/graph.hpp"

namespace irt::checker {

/// The lowest place in modification order that a read by `thread` may read from.
std::size_t lowest_readable(const Graph& graph, unsigned thread, std::uint32_t location);
/// Whether a modification may read the store at `place`: no other one has.
bool free_to_modify(const Graph& graph, std::uint32_t location, std::size_t place);
/// Whether a store may be put at `place` without parting a modification from what it read.
bool free_to_place(const Graph& graph, std::uint32_t location, std::size_t place);

/// The place of `store` in the modification order of its location.
std::size_t place_of(const Graph& graph, EventId store);
/// Its place at `location`; none if it is no store of that location, or no more.
std::optional<std::size_t> find_place(const Graph& graph, std::uint32_t location, EventId store);

}  // namespace irt::checker
