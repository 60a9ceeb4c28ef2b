/// The figures of merit that tools write, and the choices in which runs differ.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "bench/report/results.hpp"

namespace irt {

/// A figure of merit. Where a run has `key` with "_low" and "_high" behind it, that is its
/// interval.
struct Metric {
  std::string_view key;
  std::string_view title;         ///< with the unit in brackets
  std::string_view samples = {};  ///< field with one value per repetition, in the same unit
  bool skip_zeros = false;        ///< no plot where all values are 0
  std::string_view add = {};      ///< a second field that is added
};
std::span<const Metric> metrics(Family family);

/// Its value in a run; nothing where it was not measured.
std::optional<double> value_of(const Run& run, const Metric& metric);

/// A choice that was made before measuring.
struct Choice {
  std::string_view key;
  std::string_view title;
  bool sweep = false;    ///< a number that figures may be drawn over
  bool derived = false;  ///< follows from scenario and threads as a rule
};
std::span<const Choice> choices(Family family);

}  // namespace irt
