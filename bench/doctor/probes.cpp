#include "bench/doctor/probes.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace irt::doctor {
namespace {

struct BusyTime {
  double busy = 0;  ///< clock ticks of all processors together
  bool known = false;
};

BusyTime busy_time() {
  std::ifstream in("/proc/stat");
  std::string cpu;
  // user, nice, system, idle, iowait, irq, softirq, steal
  std::array<double, 8> ticks{};
  in >> cpu;
  for (double& value : ticks) in >> value;
  if (!in || cpu != "cpu") return {};
  return {ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7], true};
}

}  // namespace

std::optional<std::string> why_no_hardware_counters() {
  perf_event_attr counter{};
  counter.size = sizeof(counter);
  counter.type = PERF_TYPE_HARDWARE;
  counter.config = PERF_COUNT_HW_CPU_CYCLES;
  counter.exclude_kernel = 1;
  counter.exclude_hv = 1;
  const long descriptor = syscall(SYS_perf_event_open, &counter, 0, -1, -1, 0);
  if (descriptor >= 0) {
    close(static_cast<int>(descriptor));
    return std::nullopt;
  }
  switch (errno) {
    case EACCES:
    case EPERM:
      return "the system forbids them to this user (kernel.perf_event_paranoid, or a container)";
    case ENOENT:
    case EOPNOTSUPP:
    case ENODEV:
      return "the processor shows none, as on most virtual machines";
    case ENOSYS:
      return "the kernel has no perf_event";
    default:
      return std::string("perf_event_open: ") + std::strerror(errno);
  }
}

std::optional<double> foreign_load(std::chrono::milliseconds span) {
  const BusyTime before = busy_time();
  const auto start = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(span);
  const BusyTime after = busy_time();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const auto ticks_per_second = static_cast<double>(sysconf(_SC_CLK_TCK));
  if (!before.known || !after.known) return std::nullopt;
  return (after.busy - before.busy) / ticks_per_second / seconds.count();
}

double clock_cost_ns() {
  constexpr int readings = 20'000;
  const auto start = std::chrono::steady_clock::now();
  auto last = start;
  for (int i = 0; i < readings; ++i) last = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::nano>(last - start).count() / readings;
}

}  // namespace irt::doctor
