#include <gtest/gtest.h>

#include "bench/contention/compare.hpp"
#include "bench/results/fields.hpp"

namespace irt::contention {
namespace {

using nlohmann::json;

json run(const char* queue, unsigned threads, const std::vector<double>& samples) {
  return {{"kind", "contention"}, {"queue", queue},       {"scenario", "pairs"},
          {"producers", threads}, {"consumers", threads}, {"threads", threads},
          {"work_ns", 100},       {"capacity", 64},       {"placement", "close"},
          {"samples", samples}};
}

const std::vector<double> low{10, 11, 12, 13, 14}, high{20, 21, 22, 23, 24};

TEST(Comparison, PairsWhatDiffersInNothingElse) {
  const json before{run("lock", 1, low), run("lock", 2, low), run("lfree", 2, low)};
  const json after{run("lock", 2, high), run("lock", 4, high), run("lfree", 2, low)};
  const auto lines = compare_runs(before, after, {});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0]["queue"], "lock");
  EXPECT_EQ(lines[0]["threads"], 2);
  EXPECT_EQ(lines[0]["verdict"], "faster");
  EXPECT_DOUBLE_EQ(lines[0]["ratio"].get<double>(), 22.0 / 12);
  EXPECT_LT(lines[0]["p"].get<double>(), 0.01);
  EXPECT_EQ(lines[1]["verdict"], "no difference");
  EXPECT_DOUBLE_EQ(lines[1]["ratio"].get<double>(), 1);
}

TEST(Comparison, RunsThatDifferInOneChoiceAreNoPair) {
  for (const results::Field& field : results::fields) {
    if (field.role != results::Role::choice || (field.by & results::by_contention) == 0) continue;
    if (field.place == results::Place::origin) continue;
    json one = run("lock", 1, low), other = one;
    one[std::string(field.key)] = "one";
    other[std::string(field.key)] = "other";
    EXPECT_TRUE(compare_runs(json::array({one}), json::array({other}), {}).empty()) << field.key;
  }
}

// The allocator is what one compares, too.
TEST(Comparison, RunsUnderOtherConditionsAreAPair) {
  json one = run("lock", 1, low), other = run("lock", 1, high);
  one["allocator"] = "one";
  other["allocator"] = "other";
  EXPECT_EQ(compare_runs(json::array({one}), json::array({other}), {}).size(), 1U);
}

TEST(Comparison, TwoQueuesOfOneSweep) {
  const json runs{run("lock", 1, high), run("lfree", 1, low), run("lock", 2, low),
                  run("lfree", 2, low)};
  const auto lines = compare_runs(runs, runs, {"lock", "lfree"});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0]["against"], "lfree");
  EXPECT_EQ(lines[0]["verdict"], "slower");
}

json round_of(const char* queue, const char* time, const std::vector<double>& samples,
              const std::vector<unsigned>& rounds) {
  json one = run(queue, 1, samples);
  one["conditions"] = {{"time", time}};
  one["seed"] = 1;
  one["rounds"] = rounds;
  return one;
}

TEST(Comparison, RoundsOfOneSweepArePairedAndThoseOfTwoAreNot) {
  // Each is 2 % faster in its round, and the rounds differ by far more.
  const std::vector<double> pace{10, 20, 30, 40, 50, 60, 70};
  std::vector<double> faster;
  faster.reserve(pace.size());
  for (const double one : pace) faster.push_back(one * 1.02 + one * one * 1e-6);
  const std::vector<unsigned> all{0, 1, 2, 3, 4, 5, 6};
  const json one_sweep{round_of("lock", "noon", pace, all), round_of("lfree", "noon", faster, all)};
  const auto paired = compare_runs(one_sweep, one_sweep, {"lock", "lfree"})[0];
  EXPECT_EQ(paired["test"], "signed-rank");
  EXPECT_EQ(paired["pairs"], 7);
  EXPECT_EQ(paired["verdict"], "faster");
  EXPECT_NEAR(paired["ratio"].get<double>(), 1.02, 0.001);

  const json another{round_of("lfree", "one o'clock", faster, all)};
  const auto apart = compare_runs(one_sweep, another, {"lock", "lfree"})[0];
  EXPECT_EQ(apart["test"], "mann-whitney");
  EXPECT_EQ(apart["verdict"], "no difference");

  // A round that one of them failed in has no pair; the others keep theirs.
  std::vector<double> without = faster;
  without.erase(without.begin() + 2);
  const json gap{round_of("lock", "noon", pace, all),
                 round_of("lfree", "noon", without, {0, 1, 3, 4, 5, 6})};
  const auto six = compare_runs(gap, gap, {"lock", "lfree"})[0];
  EXPECT_EQ(six["pairs"], 6);
  EXPECT_EQ(six["verdict"], "faster");
}

TEST(Comparison, WithoutFiguresThereIsNoVerdict) {
  const json hung{run("lock", 1, {})}, few{run("lock", 1, {1, 2})}, many{run("lock", 1, low)};
  EXPECT_EQ(compare_runs(hung, many, {})[0]["verdict"], "too few repetitions");
  EXPECT_EQ(compare_runs(few, many, {})[0]["verdict"], "too few repetitions");
  EXPECT_TRUE(compare_runs(few, few, {})[0]["ratio_low"].is_null());
}

}  // namespace
}  // namespace irt::contention
