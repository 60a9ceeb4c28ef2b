/// From what a machine has to what that means for the figures.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/conditions/system.hpp"
#include "bench/conditions/topology.hpp"
#include "bench/doctor/optional_parts.hpp"

namespace irt::doctor {

enum class Severity : std::uint8_t {
  good,     ///< nothing to do
  note,     ///< to be known when figures are read
  caution,  ///< bends the figures
};

/// One line of the examination.
struct Diagnosis {
  std::string subject;  ///< "Processors", "Clock" ...
  std::string found;    ///< what is there
  Severity severity = Severity::good;
  std::string meaning;  ///< for the figures, in a sentence or two
};

/// Everything that was examined.
struct Examination {
  Topology topology;
  System system;
  std::optional<std::string> no_hardware_counters;  ///< why; nothing where they can be read
  std::optional<double> foreign_load;               ///< processors
  double clock_cost_ns = 0;
};

/// Examines this machine; takes about a third of a second.
Examination examine();

/// What it means, in a fixed order of subjects. No look at the machine: everything is in the
/// arguments.
std::vector<Diagnosis> diagnose(const Examination& examination,
                                std::span<const OptionalPart> parts);

}  // namespace irt::doctor
