/// What a measurement costs the machine: memory, context switches, processor time, energy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace irt::contention {

/// Since the process began.
struct Usage {
  double cpu_seconds = 0;              ///< of the given threads, to the nanosecond
  std::uint64_t context_switches = 0;  ///< of all but the calling thread, voluntary or not
};
Usage usage_so_far(std::span<std::thread> threads);

/// Watches the memory of the process.
class MemoryUse {
 public:
  /// From here on. Where the kernel lets a process forget its earlier peak, it is forgotten.
  MemoryUse();
  /// The most that was resident, above what was at construction.
  [[nodiscard]] std::uint64_t peak_bytes() const;
  /// What the C library's allocator has given out since construction and not got back, by its own
  /// books (mallinfo2(3)). What a queue maps by itself is not in them; nothing where another
  /// allocator (LD_PRELOAD, a sanitizer's) has taken its place.
  [[nodiscard]] std::optional<std::uint64_t> held_bytes() const;

 private:
  std::uint64_t resident_before_ = 0;
  std::optional<std::uint64_t> allocated_before_;
};

/// The energy counters of the processor packages (RAPL), as the kernel shows them.
class EnergyMeter {
 public:
  explicit EnergyMeter(const std::filesystem::path& root = "/sys/class/powercap");

  /// Why there is nothing to read; empty where there is.
  [[nodiscard]] const std::string& missing() const { return missing_; }
  void start();
  /// Joules of all packages since `start()`; the counters may have wrapped around once.
  [[nodiscard]] std::optional<double> joules() const;

 private:
  struct Package {
    std::filesystem::path counter;
    std::uint64_t range = 0, begin = 0;  // microjoules
  };
  std::vector<Package> packages_;
  std::string missing_;
};

}  // namespace irt::contention
