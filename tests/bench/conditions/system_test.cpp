#include "bench/conditions/system.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <string>

namespace irt {
namespace {

/// A made-up /proc and /sys.
class SystemTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove_all(root_); }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void write(const std::string& path, const std::string& text) {
    const auto file = root_ / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  const std::filesystem::path root_ =
      std::filesystem::path(testing::TempDir()) /
      ("irt_system_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(SystemTest, ReadsADesktop) {
  write("proc/cpuinfo",
        "processor\t: 0\nmodel name\t: Some CPU\nflags\t\t: fpu constant_tsc nonstop_tsc\n\n"
        "processor\t: 1\nmodel name\t: Another CPU\n");
  write("proc/meminfo", "MemTotal:       16000 kB\nMemFree:        1 kB\n");
  write("proc/loadavg", "1.25 0.10 0.05 1/100 42\n");
  write("proc/sys/kernel/osrelease", "6.1.0-test\n");
  write("proc/sys/kernel/perf_event_paranoid", "-1\n");
  write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  write("sys/devices/system/cpu/intel_pstate/no_turbo", "0\n");
  write("sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never\n");
  write("sys/kernel/mm/hugepages/hugepages-2048kB/nr_hugepages", "12\n");

  const System found = survey_system(root_);
  EXPECT_EQ(found.cpu_model, "Some CPU");
  EXPECT_EQ(found.memory_bytes, 16000u * 1024);
  EXPECT_EQ(found.load_average, 1.25);
  EXPECT_EQ(found.kernel, "6.1.0-test");
  EXPECT_EQ(found.perf_event_paranoid, -1);
  EXPECT_EQ(found.governor, "powersave");
  EXPECT_EQ(found.turbo, true);
  EXPECT_EQ(found.transparent_huge_pages, "madvise");
  EXPECT_EQ(found.reserved_huge_pages, 12u);
  EXPECT_TRUE(found.invariant_tsc);
  EXPECT_FALSE(found.virtual_machine);
  EXPECT_FALSE(found.cpu_limit);
}

TEST_F(SystemTest, SeesAVirtualMachineWithoutInvariantTsc) {
  write("proc/cpuinfo", "flags\t\t: fpu constant_tsc hypervisor\n");
  const System found = survey_system(root_);
  EXPECT_TRUE(found.virtual_machine);
  EXPECT_FALSE(found.invariant_tsc);
}

TEST_F(SystemTest, TakesTheStrictestLimitOfNestedControlGroups) {
  write("proc/self/cgroup", "0::/outer/inner\n");
  write("sys/fs/cgroup/outer/inner/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/outer/cpu.max", "150000 100000\n");
  EXPECT_EQ(survey_system(root_).cpu_limit, 1.5);
  write("sys/fs/cgroup/outer/inner/cpu.max", "50000 100000\n");
  EXPECT_EQ(survey_system(root_).cpu_limit, 0.5);
}

TEST_F(SystemTest, ReadsTheLimitOfVersionOneControlGroups) {
  write("proc/self/cgroup", "4:memory:/box\n2:cpu,cpuacct:/box\n0::/\n");
  write("sys/fs/cgroup/cpu/box/cpu.cfs_quota_us", "200000\n");
  write("sys/fs/cgroup/cpu/box/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(survey_system(root_).cpu_limit, 2.0);
  write("sys/fs/cgroup/cpu/box/cpu.cfs_quota_us", "-1\n");
  EXPECT_FALSE(survey_system(root_).cpu_limit);
}

TEST_F(SystemTest, NothingReadableIsNothingKnown) {
  const System found = survey_system(root_);
  EXPECT_EQ(found.cpu_model, "");
  EXPECT_EQ(found.governor, "");
  EXPECT_EQ(found.turbo, std::nullopt);
  EXPECT_EQ(found.perf_event_paranoid, std::nullopt);
  EXPECT_EQ(found.load_average, 0);
}

}  // namespace
}  // namespace irt
