#include <gtest/gtest.h>

#include "bench/contention/compare.hpp"

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

TEST(Comparison, TwoQueuesOfOneSweep) {
  const json runs{run("lock", 1, high), run("lfree", 1, low), run("lock", 2, low),
                  run("lfree", 2, low)};
  const auto lines = compare_runs(runs, runs, {"lock", "lfree"});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0]["against"], "lfree");
  EXPECT_EQ(lines[0]["verdict"], "slower");
}

TEST(Comparison, WithoutFiguresThereIsNoVerdict) {
  const json hung{run("lock", 1, {})}, few{run("lock", 1, {1, 2})}, many{run("lock", 1, low)};
  EXPECT_EQ(compare_runs(hung, many, {})[0]["verdict"], "too few repetitions");
  EXPECT_EQ(compare_runs(few, many, {})[0]["verdict"], "too few repetitions");
  EXPECT_TRUE(compare_runs(few, few, {})[0]["ratio_low"].is_null());
}

}  // namespace
}  // namespace irt::contention
