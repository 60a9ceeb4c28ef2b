#include "bench/many_core/calibration/calibrate.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <sched.h>

namespace irt::many_core {
namespace {

TEST(Spread, DropsBurstsThatWereInterrupted) {
  std::vector<double> samples(90, 10);
  for (int i = 0; i < 10; ++i) samples.push_back(1e6);
  samples.push_back(12);
  const Spread spread = summarise(samples);
  EXPECT_DOUBLE_EQ(spread.median, 10);
  EXPECT_EQ(spread.bursts, 101U);
  EXPECT_EQ(spread.dropped, 10U);
  EXPECT_LE(spread.high, 12);
  EXPECT_DOUBLE_EQ(summarise({}).median, 0);
}

// Two sockets, two caches each, two cores around a cache, two threads to a core, in the order in
// which some systems number them: siblings side by side.
std::vector<Place> sixteen() {
  std::vector<Place> places;
  for (unsigned cpu = 0; cpu < 16; ++cpu) {
    places.push_back(
        {.cpu = cpu, .core = cpu / 2, .cache = cpu / 4, .node = cpu / 8, .socket = cpu / 8});
  }
  return places;
}

TEST(Calibrate, FindsTheGroupsOfCores) {
  std::vector<Place> places = sixteen();
  std::ranges::reverse(places);
  Profile profile;
  ASSERT_TRUE(settle_topology(places, profile));
  EXPECT_EQ(profile.sockets, 2U);
  EXPECT_EQ(profile.nodes_per_socket, 1U);
  EXPECT_EQ(profile.caches_per_node, 2U);
  EXPECT_EQ(profile.cores_per_cache, 2U);
  EXPECT_EQ(profile.smt, 2U);
  // As the profile numbers them: siblings last, and as far apart as the groups say.
  for (unsigned a = 0; a < 16; ++a) {
    for (unsigned b = 0; b < 16; ++b) {
      const Place &x = places[a], &y = places[b];
      const Distance expected = a == b                 ? Distance::self
                                : x.core == y.core     ? Distance::smt_sibling
                                : x.cache == y.cache   ? Distance::same_cache
                                : x.socket == y.socket ? Distance::same_node
                                                       : Distance::other_socket;
      EXPECT_EQ(profile.distance(a, b), expected) << a << ' ' << b;
    }
  }
}

TEST(Calibrate, LeavesOutGroupsThatAreNotAlike) {
  for (const std::size_t taken : {0U, 3U, 7U}) {
    std::vector<Place> places = sixteen();
    places.erase(places.begin() + static_cast<std::ptrdiff_t>(taken));
    Profile profile;
    EXPECT_FALSE(settle_topology(places, profile));
    EXPECT_EQ(profile.threads(), 15U);
    EXPECT_EQ(profile.cores_per_cache, 15U);
  }
  // Counts that divide, groups that do not: three cores around one cache, one around the other.
  std::vector<Place> places;
  for (unsigned core = 0; core < 4; ++core) {
    places.push_back({.cpu = core, .core = core, .cache = core / 3});
  }
  Profile profile;
  EXPECT_FALSE(settle_topology(places, profile));
}

class Bound {
 public:
  Bound() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
      if (CPU_ISSET(cpu, &before_)) CPU_SET(cpu, &one);
    }
    sched_setaffinity(0, sizeof one, &one);
  }
  ~Bound() { sched_setaffinity(0, sizeof before_, &before_); }
  Bound(const Bound&) = delete;
  Bound& operator=(const Bound&) = delete;

 private:
  cpu_set_t before_{};
};

TEST(Calibrate, SaysWhatOneCoreCannotTell) {
  const Bound bound;
  const Calibration found = calibrate("here", "2000-01-01");
  EXPECT_EQ(found.profile.threads(), 1U);
  ASSERT_EQ(found.remarks.size(), 1U);
  EXPECT_NE(found.remarks[0].find("transfers between cores"), std::string::npos);
  const Profile again = parse_profile(to_text(found.profile), "here.json");
  EXPECT_EQ(again.origins.at("rmw_hit").source, "measured, 2000-01-01");
  EXPECT_NE(again.origins.at("conflict").source.find("assumed"), std::string::npos);
  // What holds on every machine: an atomic update takes longer than a plain access, a call of the
  // system longer than that.
  EXPECT_GT(again.plain_op, 0);
  EXPECT_GT(again.rmw_hit, again.plain_op);
  EXPECT_GT(again.syscall, again.rmw_hit);
  EXPECT_LE(again.origins.at("rmw_hit").low, again.rmw_hit);
}

}  // namespace
}  // namespace irt::many_core
