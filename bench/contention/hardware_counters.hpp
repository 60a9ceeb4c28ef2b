/// The processor's event counters, where the system lets this process read them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace irt::contention {

/// What is counted, as perf_event_open(2) calls it.
struct HardwareEvent {
  std::string_view name;
  std::uint32_t type = 0;
  std::uint64_t config = 0;
};

/// instructions, cycles, cache_references and cache_misses (as the processor's maker understands
/// them, usually of the last level), l1d_read_misses, branch_misses.
std::span<const HardwareEvent> hardware_events();

/// Counts events of all threads that are started after it was made, in user mode; those that the
/// system does not let us count are left out.
class HardwareCounters {
 public:
  explicit HardwareCounters(std::span<const HardwareEvent> events);
  HardwareCounters(const HardwareCounters&) = delete;
  HardwareCounters& operator=(const HardwareCounters&) = delete;
  ~HardwareCounters();

  /// Why there is nothing to read; empty where there is.
  [[nodiscard]] const std::string& missing() const { return missing_; }
  void start();
  void stop();
  /// By name, between all pairs of `start()` and `stop()`; null where nothing can be read. Where
  /// the processor has fewer counters than there are events, each is scaled up by the share of time
  /// it was counted.
  [[nodiscard]] nlohmann::json read() const;

 private:
  struct Reading {
    std::uint64_t value = 0, enabled = 0, running = 0;
  };
  struct Counter {
    std::string_view name;
    int descriptor = -1;
    Reading begin, sum;
  };
  static Reading read(int descriptor);

  std::vector<Counter> counters_;
  std::string missing_;
};

}  // namespace irt::contention
