/// What a reader must know beside a figure: claims, conditions, how it was measured.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/report/results.hpp"

namespace irt::report {

inline constexpr const char* not_measured = "not measured";
inline constexpr const char* not_recorded = "not recorded";

struct Fact {
  std::string name, value;
};

/// What is said once beneath a figure of at least one run: each fact with every value that its runs
/// have.
std::vector<Fact> facts_of(const Results& results, std::span<const std::size_t> runs);

/// What is said of each series of a figure: ordering, progress, bound, reclaimer, allocator, failed
/// operations, repetitions, source, environment, status; in the order of `series_columns()`.
std::vector<std::string> series_columns();
std::vector<std::string> series_facts(const Results& results, std::span<const std::size_t> runs);

}  // namespace irt::report
