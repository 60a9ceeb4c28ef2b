#include "bench/conditions/conditions.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
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
