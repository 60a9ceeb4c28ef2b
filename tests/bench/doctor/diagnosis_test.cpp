#include "bench/doctor/diagnosis.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>

namespace irt::doctor {
namespace {

/// A machine on which nothing bends a figure.
Examination quiet_machine() {
  Examination machine;
  machine.topology = {.packages = 1,
                      .numa_nodes = 1,
                      .cores = 8,
                      .hardware_threads = 8,
                      .machine_threads = 8,
                      .caches = {{.level = 1, .bytes = 32768, .instances = 8, .line_bytes = 64}}};
  machine.system.cpu_model = "Some CPU";
  machine.system.governor = "performance";
  machine.system.turbo = false;
  machine.system.invariant_tsc = true;
  machine.system.clock_source = "tsc";
  machine.system.transparent_huge_pages = "always";
  machine.foreign_load = 0.0;
  machine.clock_cost_ns = 20;
  return machine;
}

Diagnosis about(const std::string& subject, const Examination& machine,
                std::span<const OptionalPart> parts = {}) {
  for (const Diagnosis& diagnosis : diagnose(machine, parts)) {
    if (diagnosis.subject == subject) return diagnosis;
  }
  throw std::out_of_range("no diagnosis about " + subject);
}

TEST(Diagnosis, FindsNothingWrongWithAQuietMachine) {
  for (const Diagnosis& diagnosis : diagnose(quiet_machine(), {})) {
    EXPECT_EQ(diagnosis.severity, Severity::good) << diagnosis.subject << ": " << diagnosis.found;
    EXPECT_FALSE(diagnosis.meaning.empty()) << diagnosis.subject;
  }
}

TEST(Diagnosis, WarnsOfAVirtualMachine) {
  Examination machine = quiet_machine();
  machine.system.virtual_machine = true;
  machine.system.hypervisor = "KVM";
  EXPECT_EQ(about("Processor", machine).severity, Severity::caution);
  EXPECT_NE(about("Processor", machine).found.find("KVM"), std::string::npos);
}

TEST(Diagnosis, SaysWhereSharedCoresLimitTheSpeedUp) {
  Examination machine = quiet_machine();
  machine.topology.hardware_threads = machine.topology.machine_threads = 16;
  const Diagnosis cores = about("Cores", machine);
  EXPECT_EQ(cores.severity, Severity::note);
  EXPECT_NE(cores.meaning.find("beyond 8 threads"), std::string::npos) << cores.meaning;
}

TEST(Diagnosis, MentionsProcessorsTakenAwayByAnAffinityMask) {
  Examination machine = quiet_machine();
  machine.topology.machine_threads = 64;
  EXPECT_EQ(about("Cores", machine).severity, Severity::note);
}

TEST(Diagnosis, WarnsOfAGovernorThatFollowsTheLoad) {
  Examination machine = quiet_machine();
  machine.system.governor = "powersave";
  EXPECT_EQ(about("Frequency", machine).severity, Severity::caution);
  machine.system.governor = "performance";
  machine.system.turbo = true;
  EXPECT_EQ(about("Frequency", machine).severity, Severity::note);
}

TEST(Diagnosis, WarnsOfASlowClock) {
  Examination machine = quiet_machine();
  machine.clock_cost_ns = 800;
  EXPECT_EQ(about("Clock", machine).severity, Severity::caution);
}

TEST(Diagnosis, WarnsOfALimitBelowTheProcessorsOnly) {
  Examination machine = quiet_machine();
  machine.system.cpu_limit = 1.5;
  EXPECT_EQ(about("Processor limit", machine).severity, Severity::caution);
  EXPECT_NE(about("Processor limit", machine).meaning.find("1 thread"), std::string::npos);
  machine.system.cpu_limit = 8.0;
  EXPECT_EQ(about("Processor limit", machine).severity, Severity::good);
}

TEST(Diagnosis, WarnsOfForeignLoad) {
  Examination machine = quiet_machine();
  machine.foreign_load = 0.9;
  EXPECT_EQ(about("Other programs", machine).severity, Severity::caution);
}

TEST(Diagnosis, SaysWhyThereAreNoCounters) {
  Examination machine = quiet_machine();
  machine.no_hardware_counters = "the kernel has no perf_event";
  EXPECT_EQ(about("Hardware counters", machine).severity, Severity::note);
  EXPECT_NE(about("Hardware counters", machine).found.find("no perf_event"), std::string::npos);
}

TEST(Diagnosis, NamesThePackageOfAPartThatIsOff) {
  const std::vector<OptionalPart> parts{{"queue one", "libone-dev", true},
                                        {"queue two", "libtwo-dev", false}};
  EXPECT_EQ(about("queue one", quiet_machine(), parts).severity, Severity::good);
  const Diagnosis off = about("queue two", quiet_machine(), parts);
  EXPECT_EQ(off.found, "off");
  EXPECT_NE(off.meaning.find("libtwo-dev"), std::string::npos);
}

}  // namespace
}  // namespace irt::doctor
