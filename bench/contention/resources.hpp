/// What a measurement costs the machine: memory, context switches, processor time, energy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace irt::contention {

/// Of this process, since it began.
struct Usage {
  double cpu_seconds = 0;
  std::uint64_t context_switches = 0;  ///< voluntary or not
};
Usage usage_so_far();

/// Watches how much memory of the process is resident.
class MemoryPeak {
 public:
  /// From here on. Where the kernel lets a process forget its earlier peak, it is forgotten.
  MemoryPeak();
  /// The most above what was resident at construction.
  std::uint64_t bytes() const;

 private:
  std::uint64_t before_ = 0;
};

/// The energy counters of the processor packages (RAPL), as the kernel shows them.
class EnergyMeter {
 public:
  explicit EnergyMeter(const std::filesystem::path& root = "/sys/class/powercap");

  /// Why there is nothing to read; empty where there is.
  const std::string& missing() const { return missing_; }
  void start();
  /// Joules of all packages since `start()`; the counters may have wrapped around once.
  std::optional<double> joules() const;

 private:
  struct Package {
    std::filesystem::path counter;
    std::uint64_t range = 0, begin = 0;  // microjoules
  };
  std::vector<Package> packages_;
  std::string missing_;
};

}  // namespace irt::contention
