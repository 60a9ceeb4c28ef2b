/// What the operating system says that bears on a measurement.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace irt {

/// Empty strings and empty optionals mean that the system does not tell.
struct System {
  std::string cpu_model;
  std::string kernel;
  std::uint64_t memory_bytes = 0;
  bool virtual_machine = false;
  std::string hypervisor;              ///< its name, on a virtual machine
  std::string governor;                ///< frequency policy of the first processor
  std::optional<bool> turbo;           ///< frequency may rise with load and heat
  bool invariant_tsc = false;          ///< the time-stamp counter keeps its pace and never stops
  std::string clock_source;            ///< what the kernel's clock reads
  std::optional<double> cpu_limit;     ///< processors' worth of time the control group grants
  std::string transparent_huge_pages;  ///< always, madvise or never
  std::uint64_t reserved_huge_pages = 0;
  std::optional<int> perf_event_paranoid;
  double load_average = 0;  ///< processes wanting a processor, mean of the last minute
};

/// Reads /proc and /sys below `root`; another root than "/" is for tests.
System survey_system(const std::filesystem::path& root = "/");

}  // namespace irt
