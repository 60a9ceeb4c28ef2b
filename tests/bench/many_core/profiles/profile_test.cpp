#include "bench/many_core/profiles/profile.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

namespace irt::many_core {
namespace {

using Json = nlohmann::json;

Json two_by_two() {
  return Json::parse(R"({
    "name": "mine", "summary": "two sockets of two dies of two cores, two threads each",
    "topology": {"cores": 8, "sockets": 2, "nodes_per_socket": 1, "caches_per_node": 2,
                 "cores_per_cache": 2, "smt": 2},
    "clock_ghz": [3, "s"], "load_hit": [1, "s"], "rmw_hit": [6, "s", 5, 7], "pause": [10, "s"],
    "transfer": {"smt_sibling": [8, "s"], "same_cache": [20, "s"], "same_node": [50, "s"],
                 "other_socket": [100, "s"]},
    "dram": [90, "s"], "conflict": [20, "s"], "read_occupancy": [18, "s"]})");
}

std::string complaint(const Json& json) {
  try {
    parse_profile(json.dump(), "mine.json");
  } catch (const ProfileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Profile, ReadsFiguresAndDefaults) {
  const Profile profile = parse_profile(two_by_two().dump(), "mine.json");
  EXPECT_EQ(profile.cores(), 8U);
  EXPECT_EQ(profile.threads(), 16U);
  EXPECT_DOUBLE_EQ(profile.rmw_hit, 6);
  EXPECT_DOUBLE_EQ(profile.origins.at("rmw_hit").low, 5);
  EXPECT_DOUBLE_EQ(profile.origins.at("rmw_hit").high, 7);
  EXPECT_EQ(profile.origins.at("transfer.same_node").source, "s");
  EXPECT_DOUBLE_EQ(profile.far_atomic, 0);
  EXPECT_TRUE(profile.origins.at("kernel.syscall").assumed_by_default);
  EXPECT_FALSE(profile.origins.contains("transfer.same_socket"));
}

TEST(Profile, KnowsHowFarThreadsAre) {
  const Profile profile = parse_profile(two_by_two().dump(), "mine.json");
  EXPECT_EQ(profile.distance(3, 3), Distance::self);
  EXPECT_EQ(profile.distance(0, 8), Distance::smt_sibling);
  EXPECT_EQ(profile.distance(0, 1), Distance::same_cache);
  EXPECT_EQ(profile.distance(0, 9), Distance::same_cache);
  EXPECT_EQ(profile.distance(1, 2), Distance::same_node);
  EXPECT_EQ(profile.distance(3, 4), Distance::other_socket);
  EXPECT_EQ(profile.distance(11, 4), Distance::other_socket);
  EXPECT_DOUBLE_EQ(profile.transfer_between(0, 0), 0);
  EXPECT_DOUBLE_EQ(profile.transfer_between(0, 3), 50);
  EXPECT_EQ(profile.socket_of(15), 1U);
}

TEST(Profile, EveryPairHasOneDistanceAndTheLevelsNest) {
  const Profile profile = load_profile("epyc-genoa-2x96");
  std::array<unsigned, distances> seen{};
  for (unsigned a = 0; a < profile.threads(); ++a) {
    for (unsigned b = 0; b < profile.threads(); ++b) {
      ASSERT_EQ(profile.distance(a, b), profile.distance(b, a));
      ++seen[static_cast<std::size_t>(profile.distance(a, b))];
    }
  }
  const std::array<unsigned, distances> expected{192, 0, 192 * 7, 192 * 16, 192 * 72, 192 * 96};
  EXPECT_EQ(seen, expected);
}

TEST(Profile, AllThatComeWithTheProjectAreSound) {
  const std::set<std::string> expected{
      "xeon-e5420", "xeon-7400",         "xeon-5500",       "ryzen-5950x",
      "xeon-6130",  "xeon-6132",         "ice-lake-2x32",   "sapphire-rapids-2x56",
      "graviton-3", "granite-rapids-96", "epyc-milan-2x64", "epyc-genoa-2x96"};
  const auto names = profile_names();
  EXPECT_TRUE(std::ranges::includes(names, expected));
  for (const Profile& profile : profiles()) {
    for (const auto& [key, origin] : profile.origins) {
      EXPECT_FALSE(origin.source.empty()) << profile.name << ' ' << key;
    }
    // Farther is never nearer.
    double before = 0;
    for (std::size_t i = 1; i < distances; ++i) {
      if (!profile.has(static_cast<Distance>(i))) continue;
      EXPECT_GE(profile.transfer[i], before) << profile.name;
      before = profile.transfer[i];
    }
  }
}

TEST(Profile, IsReadBackFromWhatIsWritten) {
  for (const Profile& profile : profiles()) {
    const Profile again = parse_profile(to_text(profile), "again.json");
    Profile a = profile, b = again;
    for (const FigureEntry& figure : figures()) {
      EXPECT_EQ(figure.of(a), figure.of(b)) << profile.name << ' ' << figure.key;
    }
    ASSERT_EQ(again.origins.size(), profile.origins.size());
    for (const auto& [key, origin] : profile.origins) {
      EXPECT_EQ(again.origins.at(key).source, origin.source);
      EXPECT_EQ(again.origins.at(key).low, origin.low);
      EXPECT_EQ(again.origins.at(key).assumed_by_default, origin.assumed_by_default);
    }
    EXPECT_EQ(again.cores(), profile.cores());
  }
}

struct Bad {
  const char* name;
  void (*spoil)(Json&);
  const char* says;
};

class BadProfile : public testing::TestWithParam<Bad> {};

TEST_P(BadProfile, IsRefusedInOneLine) {
  Json json = two_by_two();
  GetParam().spoil(json);
  const std::string what = complaint(json);
  EXPECT_NE(what.find(GetParam().says), std::string::npos) << what;
  EXPECT_EQ(what.find('\n'), std::string::npos);
  EXPECT_EQ(what.find("mine.json: "), 0U) << what;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadProfile,
    testing::Values(
        Bad{"negative", [](Json& j) { j["rmw_hit"][0] = -1; }, "rmw_hit: is -1; must be"},
        Bad{"too_large", [](Json& j) { j["dram"][0] = 1e30; }, "dram: is 1e+30; must be"},
        Bad{"not_a_number", [](Json& j) { j["dram"][0] = nullptr; }, "dram: is null; must be"},
        Bad{"half_a_turn",
            [](Json& j) {
              j["turns"] = {0.5, "s"};
            },
            "turns: is 0.5; must be a whole number from 0 to 1"},
        Bad{"no_source", [](Json& j) { j["dram"] = 90; },
            "dram: is 90; must be [value, \"source\"]"},
        Bad{"empty_source", [](Json& j) { j["dram"][1] = ""; }, "must be [value, \"source\"]"},
        Bad{"missing", [](Json& j) { j.erase("load_hit"); }, "load_hit: is missing"},
        Bad{"missing_level", [](Json& j) { j["transfer"].erase("same_node"); },
            "transfer.same_node: is missing"},
        Bad{"no_levels", [](Json& j) { j.erase("transfer"); }, "transfer.smt_sibling: is missing"},
        Bad{"level_without_cores",
            [](Json& j) {
              j["transfer"]["same_socket"] = {9, "s"};
            },
            "transfer.same_socket: no two cores"},
        Bad{"unknown_key",
            [](Json& j) {
              j["rmw_hitt"] = {1, "s"};
            },
            "did you mean 'rmw_hit'?"},
        Bad{"unknown_level",
            [](Json& j) {
              j["transfer"]["same_nod"] = {1, "s"};
            },
            "did you mean 'same_node'?"},
        Bad{"sum", [](Json& j) { j["topology"]["cores"] = 9; },
            "topology.cores: is 9, but 2 sockets x 1 nodes x 2 caches x 2 cores are 8"},
        Bad{"no_sockets", [](Json& j) { j["topology"].erase("sockets"); },
            "topology.sockets: is missing"},
        Bad{"zero_sockets", [](Json& j) { j["topology"]["sockets"] = 0; },
            "must be a whole number"},
        Bad{"half_a_socket", [](Json& j) { j["topology"]["sockets"] = 1.5; },
            "must be a whole number"},
        Bad{"endless", [](Json& j) { j["topology"]["sockets"] = 4294967297; },
            "must be a whole number"},
        Bad{"too_many",
            [](Json& j) {
              for (const char* key : {"sockets", "nodes_per_socket", "caches_per_node"})
                j["topology"][key] = 512;
            },
            "at most 512 can be simulated"},
        Bad{"range",
            [](Json& j) {
              j["rmw_hit"] = {6, "s", 7, 8};
            },
            "outside of its range"},
        Bad{"topology_is_no_object", [](Json& j) { j["topology"] = 3; }, "must be an object"},
        Bad{"no_name", [](Json& j) { j.erase("name"); }, "name: is missing"},
        Bad{"array", [](Json& j) { j = Json::array(); }, "is no object"}),
    [](const auto& bad) { return bad.param.name; });

TEST(Profile, WhatIsNoJsonIsRefused) {
  for (const std::string text :
       {"", "{", "{\"name\": NaN}", "\xff\xfe", "{\"dram\": [1e999, \"s\"]}"}) {
    EXPECT_THROW(parse_profile(text, "mine.json"), ProfileError) << text;
  }
}

TEST(Profile, NamesTheNearestMachine) {
  const auto complaint_of = [](const char* name) -> std::string {
    try {
      load_profile(name);
    } catch (const ProfileError& error) {
      return error.what();
    }
    return "loaded";
  };
  EXPECT_NE(complaint_of("xeon-6123").find("did you mean 'xeon-6132'?"), std::string::npos);
  EXPECT_NE(complaint_of("./nowhere.json").find("cannot be read"), std::string::npos);
  EXPECT_NE(complaint_of("/").find("/: "), std::string::npos);
}

}  // namespace
}  // namespace irt::many_core
