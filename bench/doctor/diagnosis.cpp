#include "bench/doctor/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "bench/doctor/probes.hpp"

namespace irt::doctor {
namespace {

std::string plural(unsigned count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string size(std::uint64_t bytes) {
  if (bytes >= 1u << 20) return fmt::format("{:.4g} MiB", static_cast<double>(bytes) / (1 << 20));
  return fmt::format("{:.4g} KiB", static_cast<double>(bytes) / (1 << 10));
}

Diagnosis processor(const System& system) {
  const std::string model = system.cpu_model.empty() ? "unnamed" : system.cpu_model;
  if (!system.virtual_machine) {
    return {"Processor", model, Severity::good, "Not virtualised, as far as it tells."};
  }
  return {"Processor",
          fmt::format("{}, virtual machine ({})", model,
                      system.hypervisor.empty() ? "unnamed" : system.hypervisor),
          Severity::caution,
          "The host may share these cores with others and hide which share a physical core. "
          "Compare only runs that were interleaved; single absolute figures are not worth much."};
}

Diagnosis cores(const Topology& topology) {
  Diagnosis diagnosis{
      "Cores",
      fmt::format("{}, {}", plural(topology.cores, "core"),
                  plural(topology.hardware_threads, "hardware thread")),
      Severity::good,
      fmt::format("Speed-up can be measured up to {}; with more, threads take turns and one that "
                  "holds a lock may be waiting for its turn.",
                  plural(topology.hardware_threads, "thread"))};
  if (topology.smt()) {
    diagnosis.severity = Severity::note;
    diagnosis.meaning = fmt::format(
        "Two or more hardware threads share a core: beyond {} a speed-up of 1 per thread cannot "
        "be had, whatever the queue.",
        plural(topology.cores, "thread"));
  }
  if (topology.mixed_cores) {
    diagnosis.severity = Severity::caution;
    diagnosis.meaning +=
        " Cores differ in speed: pin threads, or figures depend on who runs where.";
  }
  if (topology.hardware_threads < 4) {
    diagnosis.severity = std::max(diagnosis.severity, Severity::note);
    diagnosis.meaning += " That is few: contention at scale does not show here.";
  }
  if (topology.hardware_threads < topology.machine_threads) {
    diagnosis.severity = std::max(diagnosis.severity, Severity::note);
    diagnosis.meaning += fmt::format(" This process may use only these of {}.",
                                     plural(topology.machine_threads, "hardware thread"));
  }
  return diagnosis;
}

Diagnosis memory_nodes(const Topology& topology) {
  const std::string found = fmt::format("{}, {}", plural(topology.packages, "package"),
                                        plural(topology.numa_nodes, "NUMA node"));
  if (topology.packages == 1 && topology.numa_nodes == 1) {
    return {"Memory nodes", found, Severity::good,
            "All memory is equally near; a shared queue costs the same from every core."};
  }
  return {"Memory nodes", found, Severity::note,
          "A cache line that crosses nodes costs several times one that does not. Pin threads, and "
          "read curves with a step at the node's border as what they are."};
}

Diagnosis caches(const Topology& topology) {
  std::vector<std::string> levels;
  unsigned line = 0;
  for (const CacheLevel& cache : topology.caches) {
    if (cache.instructions) continue;
    line = std::max(line, cache.line_bytes);
    levels.push_back(fmt::format("L{} {} x {}", cache.level, cache.instances, size(cache.bytes)));
  }
  if (levels.empty()) {
    return {"Caches", "not told", Severity::note, "Whether a scene fits a cache is unknown."};
  }
  Diagnosis diagnosis{
      "Caches", fmt::format("{}", fmt::join(levels, ", ")), Severity::good,
      fmt::format("Lines of {} bytes. A scene beyond the last level is also bound by "
                  "memory, and queues then differ less.",
                  line)};
  if (line != 64) {
    diagnosis.severity = Severity::note;
    diagnosis.meaning += " Queues pad for lines of 64 bytes: expect false sharing.";
  }
  return diagnosis;
}

Diagnosis clock(const Examination& examination) {
  const System& system = examination.system;
  const std::string source = system.clock_source.empty() ? "not told" : system.clock_source;
  Diagnosis diagnosis{"Clock",
                      fmt::format("{}, {:.0f} ns a reading, time-stamp counter {}", source,
                                  examination.clock_cost_ns,
                                  system.invariant_tsc ? "invariant" : "not known to be invariant"),
                      Severity::good, "Cheap and steady enough to time single tasks."};
  if (examination.clock_cost_ns > 100) {
    diagnosis.severity = Severity::caution;
    diagnosis.meaning =
        "Each reading is a system call or worse: times of single queue operations are mostly the "
        "clock's own. Frames per second are right.";
  } else if (!system.invariant_tsc) {
    diagnosis.severity = Severity::note;
    diagnosis.meaning =
        "Times in cycles may not be comparable between cores; times in seconds are.";
  }
  return diagnosis;
}

Diagnosis frequency(const System& system) {
  if (system.governor.empty()) {
    return {"Frequency", "not told", Severity::note,
            "The frequency may move under the measurement without a trace. Interleaved runs share "
            "the movement; their ratios hold."};
  }
  std::string found = "governor " + system.governor;
  if (system.turbo) found += *system.turbo ? ", turbo on" : ", turbo off";
  if (system.governor != "performance") {
    return {"Frequency", found, Severity::caution,
            "Cores change their pace with the load, so few threads and many are not measured at "
            "the same pace. 'cpupower frequency-set -g performance', as root, stops that."};
  }
  if (system.turbo.value_or(false)) {
    return {"Frequency", found, Severity::note,
            "One busy core runs faster than many: speed-ups come out lower than the queue's own."};
  }
  return {"Frequency", found, Severity::good, "The pace is steady."};
}

Diagnosis counters(const Examination& examination) {
  if (!examination.no_hardware_counters) {
    return {"Hardware counters", "available", Severity::good,
            "Cycles, cache misses and their like can be counted per run."};
  }
  std::string meaning =
      "Times and counts of the tools' own are complete; only cycles and cache "
      "misses are missing.";
  if (examination.system.perf_event_paranoid.value_or(0) > 2) {
    meaning += " 'sysctl kernel.perf_event_paranoid=2', as root, may allow them.";
  }
  return {"Hardware counters", "none: " + *examination.no_hardware_counters, Severity::note,
          meaning};
}

Diagnosis huge_pages(const System& system) {
  const std::string mode =
      system.transparent_huge_pages.empty() ? "unknown" : system.transparent_huge_pages;
  const std::string found =
      fmt::format("transparent: {}, reserved: {}", mode, system.reserved_huge_pages);
  if (mode == "always") {
    return {"Huge pages", found, Severity::good,
            "Large scenes get huge pages by themselves: few misses of the address cache."};
  }
  return {"Huge pages", found, Severity::note,
          "Memory comes in small pages: large scenes spend some time on address translation, the "
          "same for every queue."};
}

Diagnosis limits(const System& system, const Topology& topology) {
  if (!system.cpu_limit || *system.cpu_limit >= topology.hardware_threads) {
    return {"Processor limit", "none", Severity::good,
            "No control group takes processors away in the middle of a run."};
  }
  return {"Processor limit", fmt::format("{:.2f} processors", *system.cpu_limit), Severity::caution,
          fmt::format("A control group (a container's limit) stops all threads for a while once "
                      "they have used that much. Measure with at most {}.",
                      plural(static_cast<unsigned>(std::max(1.0, std::floor(*system.cpu_limit))),
                             "thread"))};
}

Diagnosis load(const Examination& examination) {
  if (!examination.foreign_load) {
    return {"Other programs", "not told", Severity::note, "Who else computes here is unknown."};
  }
  const std::string found = fmt::format("{:.2f} processors busy, load average {:.2f}",
                                        *examination.foreign_load, examination.system.load_average);
  if (*examination.foreign_load < 0.1) {
    return {"Other programs", found, Severity::good, "The machine is quiet."};
  }
  return {"Other programs", found, Severity::caution,
          "Others compute at the same time: expect wide spreads, most of all in barriers, which "
          "wait for the slowest thread. Stop them, or use fewer threads."};
}

Diagnosis optional_library(const OptionalPart& part) {
  if (part.on) return {std::string(part.name), "on", Severity::good, ""};
  return {std::string(part.name), "off", Severity::note,
          fmt::format("Missing in every table. The package {} switches it on.", part.package)};
}

}  // namespace

Examination examine() {
  return {.topology = survey_topology(),
          .system = survey_system(),
          .no_hardware_counters = why_no_hardware_counters(),
          .foreign_load = foreign_load(std::chrono::milliseconds(300)),
          .clock_cost_ns = clock_cost_ns()};
}

std::vector<Diagnosis> diagnose(const Examination& examination,
                                std::span<const OptionalPart> parts) {
  std::vector<Diagnosis> diagnoses{processor(examination.system),
                                   cores(examination.topology),
                                   memory_nodes(examination.topology),
                                   caches(examination.topology),
                                   clock(examination),
                                   frequency(examination.system),
                                   counters(examination),
                                   huge_pages(examination.system),
                                   limits(examination.system, examination.topology),
                                   load(examination)};
  for (const OptionalPart& part : parts) diagnoses.push_back(optional_library(part));
  return diagnoses;
}

}  // namespace irt::doctor
