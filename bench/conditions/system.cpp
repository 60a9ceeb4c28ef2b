#include "bench/conditions/system.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

namespace irt {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::string line;
  std::getline(std::ifstream(file) >> std::ws, line);
  return line;
}

/// The value of the first line "key ... : value" of a file like /proc/cpuinfo.
std::string field(const fs::path& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto colon = line.find(':');
    if (!line.starts_with(key) || colon == std::string::npos) continue;
    const auto value = line.find_first_not_of(" \t", colon + 1);
    return value == std::string::npos ? std::string() : line.substr(value);
  }
  return {};
}

bool has_word(const std::string& words, std::string_view wanted) {
  std::istringstream in(words);
  for (std::string word; in >> word;) {
    if (word == wanted) return true;
  }
  return false;
}

/// The word in brackets, as in "always [madvise] never".
std::string chosen(const std::string& choices) {
  const auto open = choices.find('['), close = choices.find(']');
  return open < close && close != std::string::npos ? choices.substr(open + 1, close - open - 1)
                                                    : std::string();
}

/// quota / period in processors; nothing where there is no limit or no such file.
std::optional<double> quota(const std::string& quota_text, const std::string& period_text) {
  double quota = 0, period = 0;
  if (!(std::istringstream(quota_text) >> quota) || quota <= 0) return std::nullopt;
  if (!(std::istringstream(period_text) >> period) || period <= 0) return std::nullopt;
  return quota / period;
}

/// The strictest limit on the way from this process' control group to the root. Version 2 keeps
/// "quota period" in cpu.max, version 1 has a file for each.
std::optional<double> control_group_limit(const fs::path& root) {
  std::optional<double> strictest;
  const auto consider = [&](std::optional<double> limit) {
    if (limit && (!strictest || *limit < *strictest)) strictest = limit;
  };
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool version_2 = controllers.empty();
    if (!version_2 && ("," + controllers + ",").find(",cpu,") == std::string::npos) continue;
    const fs::path top = root / (version_2 ? "sys/fs/cgroup" : "sys/fs/cgroup/cpu");
    for (fs::path group = fs::path(line.substr(second + 1)).relative_path();;
         group = group.parent_path()) {
      if (version_2) {
        std::istringstream limit(first_line(top / group / "cpu.max"));
        std::string quota_text, period_text;
        limit >> quota_text >> period_text;
        consider(quota(quota_text, period_text));
      } else {
        consider(quota(first_line(top / group / "cpu.cfs_quota_us"),
                       first_line(top / group / "cpu.cfs_period_us")));
      }
      if (group.empty()) break;
    }
  }
  return strictest;
}

/// The name a hypervisor gives itself through CPUID, in words; empty where it does not.
std::string hypervisor_name() {
#if defined(__x86_64__) || defined(__i386__)
  unsigned eax = 0;
  std::array<unsigned, 3> vendor{};
  __cpuid(0x4000'0000, eax, vendor[0], vendor[1], vendor[2]);
  std::array<char, sizeof(vendor) + 1> text{};
  std::memcpy(text.data(), vendor.data(), sizeof(vendor));
  const std::string signature(text.data());
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> known{{
      {"KVMKVMKVM", "KVM"},
      {"VMwareVMware", "VMware"},
      {"Microsoft Hv", "Hyper-V"},
      {"XenVMMXenVMM", "Xen"},
      {"VBoxVBoxVBox", "VirtualBox"},
  }};
  for (const auto& [key, name] : known) {
    if (signature == key) return std::string(name);
  }
  const bool printable =
      std::ranges::all_of(signature, [](char c) { return c >= ' ' && c <= '~'; });
  return printable ? signature : std::string();
#else
  return {};
#endif
}

std::optional<bool> turbo(const fs::path& cpus) {
  if (const auto no_turbo = first_line(cpus / "intel_pstate/no_turbo"); !no_turbo.empty()) {
    return no_turbo == "0";
  }
  if (const auto boost = first_line(cpus / "cpufreq/boost"); !boost.empty()) return boost == "1";
  return std::nullopt;
}

template <class Number>
std::optional<Number> number(const std::string& text) {
  Number value{};
  if (std::istringstream(text) >> value) return value;
  return std::nullopt;
}

}  // namespace

System survey_system(const fs::path& root) {
  const fs::path cpuinfo = root / "proc/cpuinfo", cpus = root / "sys/devices/system/cpu";
  const fs::path huge_pages = root / "sys/kernel/mm";
  const std::string flags = field(cpuinfo, "flags");

  System found;
  found.cpu_model = field(cpuinfo, "model name");
  found.kernel = first_line(root / "proc/sys/kernel/osrelease");
  found.memory_bytes =
      number<std::uint64_t>(field(root / "proc/meminfo", "MemTotal")).value_or(0) * 1024;
  found.virtual_machine = has_word(flags, "hypervisor");
  if (found.virtual_machine) found.hypervisor = hypervisor_name();
  found.governor = first_line(cpus / "cpu0/cpufreq/scaling_governor");
  found.turbo = turbo(cpus);
  found.invariant_tsc = has_word(flags, "constant_tsc") && has_word(flags, "nonstop_tsc");
  found.clock_source =
      first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  found.cpu_limit = control_group_limit(root);
  found.transparent_huge_pages = chosen(first_line(huge_pages / "transparent_hugepage/enabled"));
  found.reserved_huge_pages =
      number<std::uint64_t>(first_line(huge_pages / "hugepages/hugepages-2048kB/nr_hugepages"))
          .value_or(0);
  found.perf_event_paranoid = number<int>(first_line(root / "proc/sys/kernel/perf_event_paranoid"));
  found.load_average = number<double>(first_line(root / "proc/loadavg")).value_or(0);
  return found;
}

}  // namespace irt
