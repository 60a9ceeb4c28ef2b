/// The contention scenarios, as the command line chooses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "stress/scenarios/contention.hpp"

namespace irt::contention {

/// The scenarios with a name. Beside them, "NxM" is N producers and M consumers.
std::span<const Scenario> scenarios();

/// A scenario of the command line: one with a name, or "3x1".
struct Chosen {
  const Scenario* scenario = nullptr;
  std::optional<Roles> fixed;  ///< of "3x1"

  [[nodiscard]] std::string name() const;
  [[nodiscard]] Roles roles(unsigned threads) const {
    return fixed ? *fixed : scenario->roles(threads);
  }
};

/// Throws UsageError for an unknown name, with the nearest, and for an NxM out of range.
Chosen scenario_at(const std::string& name);

/// Why a queue with these claims cannot be used like that; empty if it can.
std::string obstacle(const Roles& roles, const Claims& claims);

/// At most so many threads in one measurement.
inline constexpr unsigned most_threads = 1024;

}  // namespace irt::contention
