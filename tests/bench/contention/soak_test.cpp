// What must hold of the figures, seen on the machine itself. Some minutes.
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/contention/compare.hpp"
#include "bench/contention/statistics.hpp"
#include "tests/bench/running_tool.hpp"

namespace irt::contention {
namespace {

using nlohmann::json;

/// A sweep over the twins, of which either can be slowed by steps of a busy wait in each push.
json sweep(unsigned repetitions, const std::string& seconds, unsigned steps_a, unsigned steps_b) {
  setenv("IRT_TWIN_A_STEPS", std::to_string(steps_a).c_str(), 1);
  setenv("IRT_TWIN_B_STEPS", std::to_string(steps_b).c_str(), 1);
  const TemporaryDirectory directory;
  const std::string plugins = IRT_TEST_PLUGINS;
  const RunningTool tool(
      IRT_CONTENTION,
      {"contention", "--plugin", plugins + "/twin-a.so", "--plugin", plugins + "/twin-b.so",
       "--queue", "twin-a,twin-b", "--threads", "1", "--seconds", seconds, "--warmup", "0.1",
       "--repetitions", std::to_string(repetitions), "--out", directory / "out"});
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  return json_of(directory / "out/contention.json");
}

TEST(Soak, TwinsAreCalledEqualAndRepeatedSweepsAgree) {
  constexpr int sweeps = 40;
  int different = 0, apart = 0;
  json before;
  for (int i = 0; i < sweeps; ++i) {
    const json runs = sweep(5, "0.03", 0, 0);
    const auto lines = compare_runs(runs, runs, {"twin-a", "twin-b"});
    ASSERT_EQ(lines.size(), 1U);
    different += lines[0]["verdict"] == "no difference" ? 0 : 1;
    for (std::size_t row = 0; i > 0 && row < runs.size(); ++row) {
      const bool overlap =
          runs[row]["operations_per_second_low"] <= before[row]["operations_per_second_high"] &&
          before[row]["operations_per_second_low"] <= runs[row]["operations_per_second_high"];
      apart += overlap ? 0 : 1;
    }
    before = runs;
  }
  RecordProperty("called_different", different);
  RecordProperty("intervals_apart", apart);
  std::printf(
      "of %d comparisons of twins %d are called different; of %d pairs of intervals of "
      "repeated sweeps %d do not overlap\n",
      sweeps, different, 2 * (sweeps - 1), apart);
  // Two of forty are expected; seven or more come once in 200 times.
  EXPECT_LE(different, 6);
  EXPECT_LE(apart, 8);
}

/// Puts the rates per second of processor time in the place of the others.
json by_processor_time(json runs) {
  for (json& run : runs) run["samples"] = run["samples_per_cpu_second"];
  return runs;
}

void print(const char* what, const nlohmann::ordered_json& line) {
  std::printf("%s: ratio %s (%s to %s), p %s, %s: %s\n", what, line["ratio"].dump().c_str(),
              line["ratio_low"].dump().c_str(), line["ratio_high"].dump().c_str(),
              line["p"].dump().c_str(), line["test"].dump().c_str(),
              line["verdict"].dump().c_str());
}

TEST(Soak, ATwinThatIsFivePerCentSlowerIsFoundAtThirtyRepetitions) {
  // How many steps five per cent are: from a twin that is slowed by far more.
  const json probe = sweep(5, "0.1", 0, 100);
  const json undisturbed = by_processor_time(probe);
  const double plain = median(undisturbed[0]["samples"].get<std::vector<double>>());
  const double slowed = median(undisturbed[1]["samples"].get<std::vector<double>>());
  const double operation = 1 / plain, step = (1 / slowed - 1 / plain) / 100;
  const auto steps = static_cast<unsigned>(std::lround(0.05 * operation / step));
  std::printf("an operation takes %.1f ns, a step %.2f ns per operation: %u steps\n",
              operation * 1e9, step * 1e9, steps);
  ASSERT_GT(steps, 0U);
  const json runs = sweep(30, "0.1", 0, steps);
  const auto line = compare_runs(runs, runs, {"twin-a", "twin-b"})[0];
  print("per second", line);
  const json by_cpu = by_processor_time(runs);
  const auto cpu_line = compare_runs(by_cpu, by_cpu, {"twin-a", "twin-b"})[0];
  print("per second of processor time", cpu_line);
  EXPECT_EQ(line["verdict"], "slower");
  EXPECT_EQ(cpu_line["verdict"], "slower");
}

TEST(Soak, TwinsOfManyRoundsAreCalledEqualByTheirPairs) {
  constexpr int sweeps = 20;
  int different = 0, different_by_cpu = 0;
  for (int i = 0; i < sweeps; ++i) {
    const json runs = sweep(10, "0.03", 0, 0), by_cpu = by_processor_time(runs);
    const auto line = compare_runs(runs, runs, {"twin-a", "twin-b"})[0];
    ASSERT_EQ(line["test"], "signed-rank");
    different += line["verdict"] == "no difference" ? 0 : 1;
    const auto cpu_line = compare_runs(by_cpu, by_cpu, {"twin-a", "twin-b"})[0];
    different_by_cpu += cpu_line["verdict"] == "no difference" ? 0 : 1;
  }
  std::printf("of %d paired comparisons of twins %d are called different, %d by processor time\n",
              sweeps, different, different_by_cpu);
  // One of twenty is expected; five or more come once in 400 times.
  EXPECT_LE(different, 4);
  EXPECT_LE(different_by_cpu, 4);
}

TEST(Soak, TheLoopTakesLessThanTwoNanoseconds) {
  const json runs = sweep(1, "0.01", 0, 0);
  EXPECT_LT(runs[0]["harness_ns"].get<double>(), 2);
  EXPECT_GT(runs[0]["harness_ns"].get<double>(), 0);
}

}  // namespace
}  // namespace irt::contention
