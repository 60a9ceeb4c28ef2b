// The tool as a user runs it: exit codes, one clear line, queues that misbehave, interruption.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "bench/contention/counting.hpp"
#include "tests/bench/fields.hpp"
#include "tests/bench/running_tool.hpp"

namespace irt {
namespace {

using nlohmann::json;

void expect_one_line(Arguments arguments, const std::string& part) {
  std::string command;
  for (const std::string& argument : arguments) command += " " + argument;
  SCOPED_TRACE(command);
  RunningTool tool(IRT_CONTENTION, std::move(arguments));
  EXPECT_EQ(tool.wait(), 2);
  const std::string said = tool.err();
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_EQ(tool.out(), "");
}

TEST(Tool, BadInputIsOneLineAndExitCodeTwo) {
  expect_one_line({"contention", "--threads", "0"}, "1 to 1024");
  expect_one_line({"contention", "--threads", "100000"}, "1 to 1024");
  expect_one_line({"contention", "--threads", "-1"}, "--threads");
  expect_one_line({"contention", "--threads", "two"}, "--threads");
  expect_one_line({"contention", "--queue", "lokc"}, "'lock'");
  expect_one_line({"contention", "--scenario", "piars"}, "'pairs'");
  expect_one_line({"contention", "--scenario", "0x3"}, "at least one");
  expect_one_line({"contention", "--scenario", "1000x1000"}, "at most 1024");
  expect_one_line({"contention", "--placement", "colse"}, "'close'");
  expect_one_line({"contention", "--work", "-5"}, "--work");
  expect_one_line({"contention", "--work", "nan"}, "--work");
  expect_one_line({"contention", "--work-spread", "2"}, "--work-spread");
  expect_one_line({"contention", "--repetitions", "0"}, "--repetitions");
  expect_one_line({"contention", "--seconds", "0"}, "--seconds");
  expect_one_line({"contention", "--capacity", "1", "--threads", "2"}, "--capacity 1");
  expect_one_line({"contention", "--shard", "3/3"}, "0 to n - 1");
  expect_one_line({"contention", "--shard", "half"}, "as 0/4");
  expect_one_line({"contention", "--queue", "local", "--scenario", "1x1"}, "local does not play");
  expect_one_line({"contention", "--plugin", "/no/such.so"}, "/no/such.so");
  expect_one_line({"contention", "--resume", "--out", "/no/such/place"}, "--resume");
  expect_one_line({"contention", "--out", "/proc/irt"}, "/proc/irt");
  expect_one_line({"contention", "--nonsense"}, "--nonsense");
  expect_one_line({"compare"}, "files");
  expect_one_line({"compare", "/no/such.json", "/no/such.json"}, "/no/such.json");
}

Arguments with(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::string plugin(const std::string& name) {
  return std::string(IRT_TEST_PLUGINS) + "/" + name + ".so";
}

// Builds with a sanitizer do not.
bool this_build_counts() {
  return contention::not_countable(QueueRegistry(), "lock").empty();
}

struct Sweep : testing::Test {
  TemporaryDirectory directory;
  std::filesystem::path out = directory / "out";
  Arguments quick{"contention", "--seconds", "0.02", "--warmup", "0.06", "--out", out};

  [[nodiscard]] json runs() const { return json_of(out / "contention.json"); }
  [[nodiscard]] std::size_t lines() const {
    const std::string text = contents(out / "contention.jsonl");
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
};

TEST_F(Sweep, WritesEveryFigureThatItPromises) {
  RunningTool tool(IRT_CONTENTION,
                   with(quick, {"--queue", "lock,tbb", "--threads", "2", "--repetitions", "3",
                                "--latency", "--json", directory / "copy.json"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err() << tool.out();
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(runs(), json_of(directory / "copy.json"));
  const json run = runs()[0];
  EXPECT_EQ(keys_of(run), fields_by(results::by_contention));
  const json types{{"kind", ""},
                   {"source", ""},
                   {"queue", ""},
                   {"scenario", ""},
                   {"operation_mix", ""},
                   {"placement", ""},
                   {"status", ""},
                   {"allocator", ""},
                   {"producers", 2},
                   {"consumers", 2},
                   {"threads", 2},
                   {"work_ns", 1.5},
                   {"capacity", 2},
                   {"repetitions", 2},
                   {"operations_per_second", 1.5},
                   {"operations_per_second_low", 1.5},
                   {"operations_per_second_high", 1.5},
                   {"failed_pops_per_second", 1.5},
                   {"failed_pushes_per_second", 1.5},
                   {"fairness", 1.5},
                   {"clock_ns", 1.5},
                   {"harness_ns", 1.5},
                   {"context_switches_per_second", 1.5},
                   {"memory_peak_bytes", 1.5},
                   {"samples", json::array()},
                   {"claims", json::object()},
                   {"conditions", json::object()},
                   {"latency_ns", json::object()}};
  for (const auto& [key, value] : types.items()) {
    ASSERT_TRUE(run.contains(key)) << key;
    EXPECT_EQ(run[key].is_number() ? "number" : run[key].type_name(),
              value.is_number() ? "number" : std::string(value.type_name()))
        << key;
  }
  for (const char* key : {"energy_joules", "counters", "retries_per_operation"}) {
    EXPECT_TRUE(run.contains(key)) << key;
  }
  EXPECT_EQ(run["status"], "ok");
  EXPECT_EQ(run["samples"].size(), 3U);
  EXPECT_EQ(run["rounds"], (json{0, 1, 2}));
  // The counting build, where there is one.
  EXPECT_EQ(run["not_counted"].is_null(), this_build_counts()) << run["not_counted"];
  EXPECT_EQ(run["counted"].is_object(), this_build_counts());
  for (const json& one : runs()) {
    EXPECT_EQ(one["retries_per_operation"].is_null(), one["not_counted"].is_string());
  }
  EXPECT_LE(run["operations_per_second_low"], run["operations_per_second"]);
  EXPECT_LE(run["operations_per_second"], run["operations_per_second_high"]);
  for (const char* method : {"push", "pop"}) {
    const json latency = run["latency_ns"][method];
    double last = 0;
    for (const char* key : {"p50", "p90", "p99", "p99.9", "p99.99", "max"}) {
      EXPECT_GE(latency[key].get<double>(), last);
      last = latency[key];
    }
  }
  for (const char* key : {"ordering", "push", "pop", "bound", "reclamation"}) {
    EXPECT_TRUE(run["claims"][key].is_string()) << key;
  }
  EXPECT_NE(tool.out().find("ns per operation"), std::string::npos);
}

TEST_F(Sweep, QueuesThatMisbehaveAreMarkedAndTheSweepGoesOn) {
  Arguments arguments = with(quick, {"--threads", "2", "--repetitions", "2", "--patience", "1",
                                     "--queue", "hanging,crashing,losing,throwing,mutex"});
  for (const char* name : {"hanging", "crashing", "losing", "throwing"}) {
    arguments = with(arguments, {"--plugin", plugin(name)});
  }
  RunningTool tool(IRT_CONTENTION, arguments);
  EXPECT_EQ(tool.wait(), 1) << tool.err();
  std::map<std::string, std::string> statuses;
  for (const json& run : runs()) {
    statuses[run["queue"]] = run["status"];
    EXPECT_EQ(run["message"] == "", run["status"] == "ok") << run["queue"];
  }
  EXPECT_EQ(statuses["hanging"], "hung");
  EXPECT_EQ(statuses["crashing"], "crashed");
  EXPECT_EQ(statuses["losing"], "failed");
  EXPECT_EQ(statuses["throwing"], "failed");
  EXPECT_EQ(statuses["mutex"], "ok");
  for (const json& run : runs()) {
    if (run["queue"] != "mutex") continue;
    EXPECT_EQ(run["samples"].size(), 2U);
    EXPECT_EQ(run["interface"], "concrete type");
  }
  EXPECT_NE(tool.out().find("elements went in"), std::string::npos) << tool.out();
}

TEST_F(Sweep, AnInterruptedOneKeepsItsResultsAndIsResumed) {
  const Arguments plan =
      with(quick, {"--queue", "lock,mutex", "--threads", "1,2", "--repetitions", "4"});
  // The header, two queues with two numbers of threads four times, and each once more to count.
  const std::size_t every_line = 1 + 2 * 2 * 4 + (this_build_counts() ? 2 * 2 : 0);
  RunningTool tool(IRT_CONTENTION, plan);
  for (int i = 0; i < 3000 && (!std::filesystem::exists(out / "contention.jsonl") || lines() < 4);
       ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  tool.signal(SIGINT);
  EXPECT_EQ(tool.wait(), 130) << tool.err();
  EXPECT_NE(tool.err().find("--resume"), std::string::npos) << tool.err();
  const std::size_t before = lines();
  EXPECT_GE(before, 4U);
  EXPECT_LT(before, every_line);
  EXPECT_FALSE(runs().empty());

  RunningTool other(IRT_CONTENTION, {"contention", "--resume", "--out", out, "--threads", "1,4"});
  EXPECT_EQ(other.wait(), 2);
  EXPECT_NE(other.err().find("threads: [1,2] before"), std::string::npos) << other.err();

  RunningTool rest(IRT_CONTENTION, {"contention", "--resume", "--out", out});
  EXPECT_EQ(rest.wait(), 0) << rest.err();
  EXPECT_EQ(lines(), every_line);
  ASSERT_EQ(runs().size(), 4U);
  for (const json& run : runs()) EXPECT_EQ(run["repetitions"], 4);
}

TEST_F(Sweep, RetriesAreThoseOfTheCountingBuild) {
  if (!this_build_counts()) GTEST_SKIP() << contention::not_countable(QueueRegistry(), "lfree");
  RunningTool tool(IRT_CONTENTION, with(quick, {"--queue", "lfree,faa", "--threads", "1,2",
                                                "--repetitions", "1", "--work", "0"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  for (const json& run : runs()) {
    SCOPED_TRACE(run["queue"].dump() + run["threads"].dump());
    const json counted = run["counted"];
    ASSERT_TRUE(counted.is_object()) << run["not_counted"];
    EXPECT_EQ(run["retries_per_operation"], counted["retries_per_operation"]);
    if (run["queue"] == "faa") {
      EXPECT_EQ(counted["compare_exchanges_per_operation"], 0);
      // A thread alone never finds the counter empty.
      if (run["threads"] == 1) {
        EXPECT_EQ(counted["other_modifications_per_operation"], 1);
      }
    } else if (run["threads"] == 1) {
      EXPECT_EQ(run["retries_per_operation"], 0);
      // Michael and Scott: two for a push, one for a pop; a reader's slots aside.
      EXPECT_NEAR(counted["compare_exchanges_per_operation"].get<double>(), 1.5, 0.01);
    }
  }
}

TEST_F(Sweep, OversubscriptionIsACaseOfItsOwn) {
  const unsigned more = std::thread::hardware_concurrency() + 1;
  RunningTool tool(IRT_CONTENTION,
                   with(quick, {"--queue", "mutex", "--threads", std::to_string(more),
                                "--repetitions", "1", "--placement", "none"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  EXPECT_TRUE(runs()[0]["oversubscribed"]);
  EXPECT_EQ(runs()[0]["placement"], "none");
  EXPECT_NE(tool.out().find("more threads than processors"), std::string::npos);
  EXPECT_TRUE(runs()[0]["operations_per_second_low"].is_null());  // of a single repetition
}

TEST_F(Sweep, ComparesWithItselfAndWithAnother) {
  RunningTool tool(IRT_CONTENTION,
                   with(quick, {"--queue", "lock,mutex", "--threads", "1", "--repetitions", "4"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  const std::string file = out / "contention.json";
  RunningTool same(IRT_CONTENTION, {"compare", file, file, "--json", directory / "compared.json"});
  EXPECT_EQ(same.wait(), 0) << same.err();
  for (const json& line : json_of(directory / "compared.json")) {
    EXPECT_EQ(line["verdict"], "no difference");
    EXPECT_EQ(line["ratio"], 1.0);
  }
  RunningTool two(IRT_CONTENTION, {"compare", file, "--queues", "lock,mutex"});
  EXPECT_EQ(two.wait(), 0) << two.err();
  EXPECT_NE(two.out().find("lock > mutex"), std::string::npos) << two.out();

  expect_one_line({"compare", file}, "--queues");
  expect_one_line({"compare", file, "--queues", "lock"}, "takes two");
  expect_one_line({"compare", file, "--queues", "lock,mutxe"}, "'mutex'");
  std::ofstream(directory / "odd.json") << "[{\"kind\": \"contention\", \"queue\": 3}]";
  expect_one_line({"compare", file, directory / "odd.json"}, "no run");
  std::ofstream(directory / "torn.json") << "[{\"kind\": ";
  expect_one_line({"compare", file, directory / "torn.json"}, "no list of runs");
}

}  // namespace
}  // namespace irt
