// Names of hardware events, resolved for processors that need not be here.
#include "bench/contention/named_events.hpp"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>
#include <linux/perf_event.h>
#include <set>
#include <string>

namespace irt::contention {
namespace {

/// Which figures libpfm can take from a processor.
std::set<std::string_view> figures_of(const std::string& pmu) {
  std::set<std::string_view> figures;
  for (const NamedEvent& event : named_events()) {
    const auto encoded = encode(event, pmu);
    if (!encoded) continue;
    figures.insert(event.figure);
    EXPECT_EQ(encoded->name, event.figure);
    EXPECT_EQ(encoded->type, static_cast<unsigned>(PERF_TYPE_RAW)) << pmu << ' ' << event.figure;
    EXPECT_NE(encoded->config, 0U) << pmu << ' ' << event.figure;
  }
  return figures;
}

std::uint64_t code(std::string_view figure, const std::string& pmu) {
  const auto event = std::ranges::find(named_events(), figure, &NamedEvent::figure);
  const auto encoded = encode(*event, pmu);
  return encoded ? encoded->config & 0xffffU : 0;  // unit mask and event
}

// Before libpfm looks, once, at whatever test asks first.
[[maybe_unused]] const int of_all_processors = setenv("LIBPFM_ENCODE_INACTIVE", "1", 1);

struct NamedEvents : testing::Test {
  void SetUp() override {
    if (named_events().empty()) GTEST_SKIP() << events_by_name().missing;
  }
};

TEST_F(NamedEvents, OfIntelProcessors) {
  const std::set<std::string_view> client{"l1_misses", "l2_misses", "l3_misses", "hitm"};
  std::set<std::string_view> server = client;
  server.insert("remote_hitm");
  for (const char* pmu : {"ivb", "hsw", "bdw", "icl"}) EXPECT_GE(figures_of(pmu), client) << pmu;
  for (const char* pmu : {"ivb_ep", "hsw_ep", "bdw_ep", "skx", "clx", "icx", "spr"}) {
    EXPECT_EQ(figures_of(pmu), server) << pmu;
  }
}

TEST_F(NamedEvents, OfAMDProcessors) {
  const std::set<std::string_view> figures{"l1_misses", "l2_misses", "other_ccx_fills"};
  EXPECT_EQ(figures_of("amd64_fam17h_zen2"), figures);
  std::set<std::string_view> newer = figures;
  newer.insert("l3_misses");
  EXPECT_EQ(figures_of("amd64_fam19h_zen3"), newer);
  EXPECT_EQ(figures_of("amd64_fam19h_zen4"), newer);
}

// By the makers' tables of events: unit mask and event select.
TEST_F(NamedEvents, HaveTheMakersCodes) {
  EXPECT_EQ(code("hitm", "skx"), 0x04d2U);         // MEM_LOAD_L3_HIT_RETIRED.XSNP_HITM
  EXPECT_EQ(code("hitm", "spr"), 0x04d2U);         // MEM_LOAD_L3_HIT_RETIRED.XSNP_FWD
  EXPECT_EQ(code("remote_hitm", "icx"), 0x04d3U);  // MEM_LOAD_L3_MISS_RETIRED.REMOTE_HITM
  EXPECT_EQ(code("l1_misses", "skx"), 0x08d1U);    // MEM_LOAD_RETIRED.L1_MISS
  EXPECT_EQ(code("l2_misses", "icx"), 0x10d1U);    // MEM_LOAD_RETIRED.L2_MISS
  EXPECT_EQ(code("l3_misses", "spr"), 0x20d1U);    // MEM_LOAD_RETIRED.L3_MISS
  EXPECT_EQ(code("l2_misses", "amd64_fam17h_zen2"), 0x0864U);        // L2CacheReqStat, LsRdBlkC
  EXPECT_EQ(code("other_ccx_fills", "amd64_fam19h_zen3"), 0x1444U);  // LsAnyFillsFromSys
}

TEST_F(NamedEvents, AProcessorThatNobodyKnowsHasNone) {
  EXPECT_TRUE(figures_of("no_such_pmu").empty());
}

TEST(EventsByName, AreThereOrItIsSaidWhyNot) {
  const EventsByName found = events_by_name();
  EXPECT_EQ(found.events.empty(), !found.missing.empty());
  EXPECT_EQ(found.missing.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace irt::contention
