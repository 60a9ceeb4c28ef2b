/// What can only be learnt by trying.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace irt::doctor {

/// Why hardware counters cannot be read by this process; nothing where they can.
std::optional<std::string> why_no_hardware_counters();

/// Processors kept busy by everyone over the next `span`, this process asleep: 0 on an idle
/// machine, at most the number of processors. Nothing where /proc/stat cannot be read.
std::optional<double> foreign_load(std::chrono::milliseconds span);

/// Nanoseconds that one reading of std::chrono::steady_clock takes.
double clock_cost_ns();

}  // namespace irt::doctor
