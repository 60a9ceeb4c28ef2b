#include "bench/contention/hardware_counters.hpp"

#include <array>
#include <cerrno>
#include <fmt/format.h>
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <system_error>
#include <unistd.h>

namespace irt::contention {
namespace {

constexpr std::uint64_t l1d_read_miss = PERF_COUNT_HW_CACHE_L1D |
                                        (PERF_COUNT_HW_CACHE_OP_READ << 8) |
                                        (PERF_COUNT_HW_CACHE_RESULT_MISS << 16);
constexpr std::array all{
    HardwareEvent{"instructions", PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    HardwareEvent{"cycles", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    HardwareEvent{"cache_references", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_REFERENCES},
    HardwareEvent{"cache_misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_MISSES},
    HardwareEvent{"l1d_read_misses", PERF_TYPE_HW_CACHE, l1d_read_miss},
    HardwareEvent{"branch_misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_BRANCH_MISSES},
};

int open_event(const HardwareEvent& event) {
  perf_event_attr wanted{};
  wanted.size = sizeof wanted;
  wanted.type = event.type;
  wanted.config = event.config;
  wanted.inherit = 1;
  wanted.exclude_kernel = 1;  // what an unprivileged process may see
  wanted.exclude_hv = 1;
  wanted.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  return static_cast<int>(syscall(SYS_perf_event_open, &wanted, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

}  // namespace

std::span<const HardwareEvent> hardware_events() {
  return all;
}

HardwareCounters::HardwareCounters(std::span<const HardwareEvent> events) {
  int error = 0;
  for (const HardwareEvent& event : events) {
    const int descriptor = open_event(event);
    if (descriptor < 0) {
      error = errno;
    } else {
      counters_.push_back({.name = event.name, .descriptor = descriptor, .begin = {}, .sum = {}});
    }
  }
  if (!counters_.empty()) return;
  missing_ = fmt::format("hardware counters: perf_event_open says '{}'",
                         std::generic_category().message(error));
  if (error == EACCES || error == EPERM) {
    missing_ += "; kernel.perf_event_paranoid=2 or less allows them";
  } else if (error == ENOENT || error == EOPNOTSUPP) {
    missing_ += "; virtual machines seldom have them";
  }
}

HardwareCounters::~HardwareCounters() {
  for (const Counter& one : counters_) close(one.descriptor);
}

HardwareCounters::Reading HardwareCounters::read(int descriptor) {
  Reading reading;
  if (::read(descriptor, &reading, sizeof reading) != sizeof reading) return {};
  return reading;
}

void HardwareCounters::start() {
  for (Counter& one : counters_) one.begin = read(one.descriptor);
}

void HardwareCounters::stop() {
  for (Counter& one : counters_) {
    const Reading end = read(one.descriptor);
    one.sum.value += end.value - one.begin.value;
    one.sum.enabled += end.enabled - one.begin.enabled;
    one.sum.running += end.running - one.begin.running;
  }
}

nlohmann::json HardwareCounters::read() const {
  nlohmann::json figures;
  for (const Counter& one : counters_) {
    if (one.sum.running == 0) continue;
    figures[std::string(one.name)] = static_cast<double>(one.sum.value) *
                                     static_cast<double>(one.sum.enabled) /
                                     static_cast<double>(one.sum.running);
  }
  return figures;
}

}  // namespace irt::contention
