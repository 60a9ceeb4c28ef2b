#include "bench/conditions/conditions.hpp"

#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "bench/conditions/topology.hpp"

namespace irt {
namespace {

TEST(Conditions, NameMachineBuildAndPinning) {
  const nlohmann::json found = conditions("one thread per core");
  EXPECT_EQ(found.at("pinning"), "one thread per core");
  EXPECT_EQ(found.at("hardware_threads"), std::thread::hardware_concurrency());
  EXPECT_GT(found.at("memory_bytes"), 0);
  EXPECT_NE(found.at("flags").get<std::string>().find("-ffp-contract=off"), std::string::npos);
  EXPECT_NE(found.at("commit"), "");
  for (const char* key :
       {"time", "cpu", "packages", "numa_nodes", "hypervisor", "governor", "turbo", "cpu_limit",
        "transparent_huge_pages", "load_average", "kernel", "compiler", "build_type"}) {
    EXPECT_TRUE(found.contains(key)) << key;
  }
}

TEST(Conditions, NameTheAllocatorAndWhatStandsBeforeIt) {
  const char* before = std::getenv("LD_PRELOAD");
  const std::string was = before == nullptr ? "" : before;
  unsetenv("LD_PRELOAD");
  const std::string alone = allocator();
  setenv("LD_PRELOAD", "/usr/lib/other.so", 1);
  const std::string behind = allocator();
  unsetenv("LD_PRELOAD");
  if (before != nullptr) setenv("LD_PRELOAD", was.c_str(), 1);
  EXPECT_TRUE(alone.starts_with("glibc 2.")) << alone;
  EXPECT_EQ(behind, alone + ", preloaded: /usr/lib/other.so");
}

TEST(Topology, IsConsistent) {
  const Topology found = survey_topology();
  EXPECT_GE(found.packages, 1u);
  EXPECT_GE(found.numa_nodes, 1u);
  EXPECT_GE(found.cores, found.packages);
  EXPECT_GE(found.hardware_threads, found.cores);
  EXPECT_GE(found.machine_threads, found.hardware_threads);
}

}  // namespace
}  // namespace irt
