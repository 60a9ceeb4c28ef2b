// The tool as a user runs it: exit codes, one clear line, interruption.
#include <chrono>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/bench/fields.hpp"
#include "tests/bench/running_tool.hpp"

namespace irt::frames {
namespace {

/// A running `irt-frames`.
class Tool : public RunningTool {
 public:
  explicit Tool(Arguments arguments) : RunningTool(IRT_FRAMES, std::move(arguments)) {}
};

void expect_one_line(Arguments arguments, const std::string& part) {
  std::string command;
  for (const std::string& argument : arguments) command += " " + argument;
  SCOPED_TRACE(command);
  Tool tool(std::move(arguments));
  EXPECT_EQ(tool.wait(), 2);
  const std::string said = tool.err();
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_EQ(tool.out(), "");
}

const Arguments quick{"--scene", "office", "--size", "32x32", "--frames", "2"};

Arguments render(const Arguments& more) {
  Arguments all{"render"};
  all.insert(all.end(), quick.begin(), quick.end());
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(Tool, NothingIsNoValue) {
  expect_one_line({"render", "--scene", ""}, "--scene: nothing");
  expect_one_line({"render", "--queue", ""}, "--queue: nothing");
  expect_one_line({"render", "--image", ""}, "--image: nothing");
  expect_one_line({"compare", "--out", ""}, "--out: nothing");
  expect_one_line({"overhead", "--json", ""}, "--json: nothing");
  expect_one_line({"compare", "--queue", "lock,"}, "number 2 of the list");
  expect_one_line({"compare", "--queue=lock", "--threads", "1,,2"}, "write --threads 1,2");
}

TEST(Tool, WhatWouldHaveNoEffectIsRefused) {
  expect_one_line(render({"--image", "x.jpg"}), "name it x.png");
  expect_one_line(render({"--shader", "depth", "--secondary", "thesis"}), "--shader whitted");
  expect_one_line({"compare", "--shader", "whitted,path", "--secondary", "single"}, "path");
  for (const char* depth : {"2", "4"}) {
    expect_one_line(render({"--shader", "diffuse", "--depth", depth}),
                    std::string("--depth ") + depth +
                        ": the shader diffuse has no bounces; "
                        "--shader whitted has");
  }
  expect_one_line({"compare", "--shader", "whitted,normals", "--depth", "2,3"}, "normals");
  expect_one_line({"overhead", "--shader", "ambient-occlusion", "--depth", "1"}, "bounces");
  expect_one_line(render({"--task-system", "tbb", "--queue", "lfree"}), "--task-system queue");
  expect_one_line({"collide", "--task-system", "openmp", "--queue", "lock"}, "--task-system queue");
  expect_one_line({"compare", "--task-system", "tbb,openmp", "--queue", "lfree"},
                  "--task-system queue");
}

TEST(Tool, FiguresOnStandardOutputAreAlone) {
  const TemporaryDirectory directory;
  Tool collide(
      {"collide", "--scene", "office", "--particles", "100", "--frames", "1", "--json", "-"});
  EXPECT_EQ(collide.wait(), 0) << collide.err();
  EXPECT_EQ(nlohmann::json::parse(collide.out(), nullptr, false).size(), 1u) << collide.out();
  EXPECT_NE(collide.err().find("100 particles"), std::string::npos) << collide.err();
  Tool compare({"compare", "--scene", "office", "--size", "32x32", "--queue", "lock", "--threads",
                "1", "--frames", "1", "--repetitions", "1", "--out", directory / "out", "--json",
                "-"});
  EXPECT_EQ(compare.wait(), 0) << compare.err();
  EXPECT_EQ(nlohmann::json::parse(compare.out(), nullptr, false).size(), 1u) << compare.out();
}

TEST(Tool, BadInputIsOneLineAndExitCodeTwo) {
  expect_one_line({"render", "--queue", "lokc"}, "lock");
  expect_one_line({"render", "--bvh", "goncalvez"}, "goncalves");
  expect_one_line({"render", "--frame-buffer", "fixedpoint"}, "fixed-point");
  expect_one_line({"render", "--shader", "withed"}, "whitted");
  expect_one_line({"render", "--secondary", "pakced"}, "packed");
  expect_one_line({"render", "--samples-per-pixel", "0"}, "from 1 to");
  expect_one_line({"render", "--samples-per-pixel", "60000"}, "fewer samples");
  expect_one_line({"render", "--termination", "leave-when-emtpy"}, "leave-when-empty");
  expect_one_line({"render", "--scene", "offise"}, "office");
  expect_one_line({"render", "--threads", "0"}, "1 to 1024");
  expect_one_line({"render", "--threads", "100000"}, "1 to 1024");
  expect_one_line({"render", "--threads", "-1"}, "1 to 1024");
  expect_one_line({"render", "--threads", "two"}, "--threads");
  expect_one_line({"render", "--size", "0x0"}, "width");
  expect_one_line({"render", "--size", "1000000x1000000"}, "width");
  expect_one_line({"render", "--size", "60000x60000"}, "GB");
  expect_one_line({"render", "--size", "99999999999999999999x1"}, "--size");
  expect_one_line({"render", "--size", "300"}, "300x300");
  expect_one_line({"render", "--size", "-3x4"}, "--size");
  expect_one_line({"render", "--task-size", "0"}, "from 1 to");
  expect_one_line({"render", "--task-size", "4000000000"}, "from 1 to");
  expect_one_line({"render", "--depth", "65"}, "from 0 to 64");
  expect_one_line({"render", "--frames", "0"}, "--frames");
  expect_one_line({"render", "--nonsense"}, "--nonsense");
  expect_one_line({"render", "--kernel", "watertigt"}, "watertight");
  expect_one_line({"render", "--width", "3"}, "1, 4, 8 or 16");
  expect_one_line({"render", "--bvh", "goncalves", "--width", "8"}, "single rays");
  expect_one_line({"render", "--bvh", "wald", "--width", "8", "--isa", "mmx"}, "machine");
  expect_one_line({"render", "--animate", "wav"}, "wave");
  expect_one_line({"render", "--animate", "wave", "--update", "rebiuld"}, "rebuild");
  expect_one_line({"render", "--update", "refit"}, "--animate");
  expect_one_line({"render", "--task-system", "qeue"}, "queue");
  expect_one_line({"render", "--task-system", "tbb", "--pin"}, "--pin");
  expect_one_line({"render", "--task-system", "tbb", "--termination", "leave-when-empty"},
                  "--task-system queue");
  expect_one_line({"compare", "--bvh", "wide,waldd"}, "wald");
  expect_one_line({"compare", "--shard", "4/4"}, "0 to n - 1");
  expect_one_line({"compare", "--shard", "0"}, "0/4");
  expect_one_line({"compare", "--shard", "2/3", "--threads", "1,2"}, "nothing is left");
  expect_one_line({"render", "--trace", "/tmp/t.json", "--plain"}, "--plain");
  expect_one_line({"render", "--trace", "/tmp/t.json", "--task-system", "tbb"},
                  "--task-system queue");
  expect_one_line({"render", "--plugin", "/no/such.so"}, "/no/such.so");
  expect_one_line({"render", "--plugin", IRT_FRAMES}, IRT_FRAMES);
  expect_one_line({"compare", "--threads", "1,0"}, "1 to 1024");
  expect_one_line({"compare", "--queue", "lock,lokal"}, "local");
  expect_one_line({"compare", "--resume", "--out", "/no/such/place"}, "--resume");
}

TEST(Tool, OutputThatCannotBeWrittenIsRefusedBeforeMeasuring) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "file") << "x";
  for (const char* option : {"--image", "--json", "--csv"}) {
    expect_one_line(render({option, "/proc/irt.out", "--warmup", "1000000"}), "/proc/irt.out");
    expect_one_line(render({option, "/proc", "--warmup", "1000000"}), "/proc");
  }
  const std::string below_a_file = directory / "file/out";
  expect_one_line({"compare", "--out", below_a_file}, below_a_file);
}

TEST(Tool, AFullDiskIsAnErrorButTheFiguresAreShown) {
  Tool tool(render({"--json", "/dev/full"}));
  EXPECT_EQ(tool.wait(), 2);
  EXPECT_NE(tool.out().find("T.Exec"), std::string::npos);
  EXPECT_NE(tool.err().find("/dev/full"), std::string::npos);
}

TEST(Tool, RenderWritesEverythingAsked) {
  const TemporaryDirectory directory;
  Tool tool(render({"--queue", "local", "--threads", "3", "--image", directory / "deep/a.png",
                    "--json", directory / "a.json", "--csv", directory / "a.csv"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  EXPECT_EQ(contents(directory / "deep/a.png").substr(1, 3), "PNG");
  EXPECT_EQ(contents(directory / "a.csv").substr(0, 6), "scene,");
  const auto run = json_of(directory / "a.json").at(0);
  const std::set<std::string> promised{
      "scene",           "triangles", "queue",      "threads",   "bvh",    "frame_buffer",
      "termination",     "width",     "height",     "task_size", "frames", "fps",
      "rays_per_second", "depth",     "image_hash", "conditions"};
  for (const std::string& name : promised) EXPECT_TRUE(run.contains(name)) << name;
  EXPECT_EQ(run["queue"], "local");
  EXPECT_EQ(run["threads"], 3);
  EXPECT_EQ(run["triangles"], 20'769);
  EXPECT_EQ(run["frames"], 2);
  EXPECT_EQ(run["image_hash"].get<std::string>().size(), 16u);
  EXPECT_EQ(run["lost_tasks"], 0);
  for (const char* name : {"cpu", "compiler", "flags", "commit", "pinning"}) {
    EXPECT_TRUE(run["conditions"].contains(name)) << name;
  }
}

TEST(Tool, JsonOnStandardOutputIsAllThatIsThere) {
  Tool tool(render({"--json", "-", "--plain"}));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  EXPECT_EQ(nlohmann::json::parse(tool.out()).size(), 1u);
}

TEST(Tool, EveryChoiceOfTheListCanBeRendered) {
  Tool tool({"list"});
  EXPECT_EQ(tool.wait(), 0);
  std::set<std::string> hashes;
  std::istringstream lines(tool.out());
  std::string line, option;
  int choices = 0;
  while (std::getline(lines, line)) {
    if (const auto at = line.find("(--"); at != std::string::npos) {
      option = line.substr(at + 1, line.find_first_of(",)", at) - at - 1);
    } else if (line.starts_with("  ") && !option.empty()) {
      const std::string name = line.substr(2, line.find(' ', 2) - 2);
      if (option == "--scene") continue;  // the other tests
      const TemporaryDirectory directory;
      Arguments arguments{"render",
                          "--scene",
                          "office",
                          "--size",
                          "24x24",
                          "--frames",
                          "1",
                          "--warmup",
                          "0",
                          "--json",
                          directory / "a.json",
                          option,
                          name};
      if (option == "--kernel") arguments.insert(arguments.end(), {"--bvh", "goncalves"});
      if (option == "--update") arguments.insert(arguments.end(), {"--animate", "wave"});
      Tool one(arguments);
      EXPECT_EQ(one.wait(), 0) << option << " " << name << ": " << one.err();
      ++choices;
      // These have a say in the picture.
      const std::set<std::string> other{"--frame-buffer", "--shader", "--kernel", "--animate",
                                        "--update"};
      if (other.contains(option)) continue;
      const auto run = json_of(directory / "a.json").at(0);
      hashes.insert(run["image_hash"].get<std::string>());
    } else {
      option.clear();
    }
  }
  EXPECT_GE(choices, 20);
  EXPECT_EQ(hashes.size(), 1u);
}

TEST(Tool, ParticlesCollideAlikeForEveryQueue) {
  const TemporaryDirectory directory;
  std::set<std::string> hashes;
  for (const char* queue : {"lock", "local", "lfree"}) {
    Tool tool({"collide", "--scene", "office", "--queue", queue, "--threads", "3", "--particles",
               "2000", "--frames", "2", "--json", directory / "a.json"});
    EXPECT_EQ(tool.wait(), 0) << tool.err();
    const auto run = json_of(directory / "a.json").at(0);
    EXPECT_GT(run["collisions"], 100);
    EXPECT_EQ(keys_of(run), fields_by(results::by_collide));
    hashes.insert(run["contacts_hash"].get<std::string>());
  }
  EXPECT_EQ(hashes.size(), 1u);
}

struct CompareTest : testing::Test {
  TemporaryDirectory directory;
  std::filesystem::path out = directory / "out";
  Arguments plan{"compare",   "--scene",  "office",  "--size",         "48x48",
                 "--threads", "1,2",      "--queue", "lock,local,tbb", "--repetitions",
                 "4",         "--frames", "2",       "--out",          out};

  static Arguments with(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] std::size_t lines() const {
    const std::string text = contents(out / "runs.jsonl");
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
  void wait_for_lines(std::size_t count) const {
    for (int i = 0; i < 3000 && lines() < count; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  // Three queues with two numbers of threads each, eight frames each, and no sample twice.
  void expect_complete() const {
    EXPECT_EQ(lines(), 1u + 3 * 2 * 4);
    const auto runs = json_of(out / "compare.json");
    EXPECT_EQ(runs.size(), 6u);
    std::set<std::string> hashes;
    for (const auto& run : runs) {
      EXPECT_EQ(run["frames"], 8);
      EXPECT_EQ(run["repetitions"], 4);
      hashes.insert(run["image_hash"].get<std::string>());
    }
    EXPECT_EQ(hashes.size(), 1u);
    EXPECT_TRUE(std::filesystem::exists(out / "frame.png"));
    EXPECT_TRUE(std::filesystem::exists(out / "compare.csv"));
  }
};

TEST_F(CompareTest, RunsThroughAndAResumeAddsNothing) {
  Tool tool(plan);
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  expect_complete();
  EXPECT_NE(tool.out().find("lock "), std::string::npos);
  Tool again({"compare", "--resume", "--out", out});
  EXPECT_EQ(again.wait(), 0) << again.err();
  expect_complete();
}

TEST_F(CompareTest, QueuesThatHangOrCrashAreRowsAndTheOthersKeepTheirs) {
  Arguments arguments{"compare",
                      "--scene",
                      "office",
                      "--size",
                      "64x64",
                      "--task-size",
                      "1",
                      "--threads",
                      "2",
                      "--repetitions",
                      "2",
                      "--frames",
                      "2",
                      "--patience",
                      "2",
                      "--queue",
                      "lock,crashing,hanging",
                      "--out",
                      out};
  for (const char* name : {"hanging", "crashing"}) {
    arguments = with(arguments, {"--plugin", std::string(IRT_TEST_PLUGINS) + "/" + name + ".so"});
  }
  Tool tool(arguments);
  EXPECT_EQ(tool.wait(), 1) << tool.err();
  const auto runs = json_of(out / "compare.json");
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0]["status"], "ok");
  EXPECT_EQ(runs[0]["frames"], 4);
  EXPECT_EQ(runs[1]["status"], "crashed");
  EXPECT_EQ(runs[1]["message"], "Aborted");
  EXPECT_EQ(runs[2]["status"], "hung");
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_TRUE(runs[i]["fps"].is_null());
    EXPECT_TRUE(runs[i]["get_ns"].is_null());
    EXPECT_EQ(runs[i]["repetitions"], 0);
  }
  EXPECT_NE(tool.out().find("crashed: Aborted"), std::string::npos) << tool.out();
  EXPECT_EQ(lines(), 1u + 2 + 2 + 1);  // what hung is not tried again
}

TEST_F(CompareTest, EveryChoiceMayBeAListAndBecomesRows) {
  Tool tool({"compare", "--scene", "office", "--size", "32x32", "--bvh", "wide,wald",
             "--task-system", "queue,tbb", "--queue", "lock,local", "--threads", "2",
             "--repetitions", "2", "--frames", "1", "--out", out});
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  const auto runs = json_of(out / "compare.json");
  ASSERT_EQ(runs.size(), 6u);  // where there is a work queue, one for each
  std::set<std::string> hashes;
  for (const auto& run : runs) hashes.insert(run["image_hash"].get<std::string>());
  EXPECT_EQ(hashes.size(), 1u);
  EXPECT_EQ(runs[2]["bvh"], "wide");
  EXPECT_EQ(runs[2]["task_system"], "tbb");
  EXPECT_TRUE(runs[2]["queue"].is_null());
  EXPECT_NE(tool.out().find("bvh   task system  queue  threads"), std::string::npos) << tool.out();
  Tool other({"compare", "--resume", "--out", out, "--bvh", "wide"});
  EXPECT_EQ(other.wait(), 2);
  EXPECT_NE(other.err().find("bvh: [\"wide\",\"wald\"] before"), std::string::npos) << other.err();
}

TEST_F(CompareTest, ShardsShareTheSweepAndQueuesStayTogether) {
  std::set<std::string> measured;
  for (const std::string shard : {"0/2", "1/2"}) {
    const std::string place = out.string() + shard.front();
    Tool tool({"compare", "--scene", "office", "--size", "32x32", "--queue", "lock,local",
               "--threads", "1,2,3", "--task-size", "16,256", "--repetitions", "2", "--frames", "1",
               "--shard", shard, "--out", place});
    EXPECT_EQ(tool.wait(), 0) << tool.err();
    std::set<std::string> cells;
    for (const auto& run : json_of(std::filesystem::path(place) / "compare.json")) {
      const std::string cell = run["task_size"].dump() + " " + run["threads"].dump();
      cells.insert(cell);
      EXPECT_TRUE(measured.insert(run["queue"].dump() + cell).second);
      EXPECT_EQ(run["fps_samples"].size(), 2u);
      EXPECT_LE(run["fps_low"], run["fps_high"]);
    }
    EXPECT_EQ(cells.size(), 3u);
    Tool other({"compare", "--resume", "--out", place, "--shard", "0/3"});
    EXPECT_EQ(other.wait(), 2);
    EXPECT_NE(other.err().find("shard"), std::string::npos) << other.err();
  }
  EXPECT_EQ(measured.size(), 12u);
}

TEST_F(CompareTest, AMovingSceneGivesTheSameFramesHoweverTheTreeFollows) {
  Tool tool({"compare",
             "--scene",
             "office",
             "--size",
             "32x32",
             "--animate",
             "swarm",
             "--bvh",
             "wide,goncalves",
             "--update",
             "refit,rebuild,auto",
             "--queue",
             "lfree",
             "--threads",
             "1,2",
             "--repetitions",
             "1",
             "--frames",
             "3",
             "--out",
             out});
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  const auto runs = json_of(out / "compare.json");
  ASSERT_EQ(runs.size(), 12u);
  std::set<std::string> hashes;
  for (const auto& run : runs) {
    hashes.insert(run["image_hash"].get<std::string>());
    EXPECT_GT(run["update_ms"], 0);
    if (run["update"] == "refit") {
      EXPECT_EQ(run["share_rebuilt"], 0);
    } else if (run["update"] == "rebuild") {
      EXPECT_EQ(run["share_rebuilt"], 1);
    }
  }
  EXPECT_EQ(hashes.size(), 1u);
  Tool still(render({"--json", out / "still.json"}));
  EXPECT_EQ(still.wait(), 0);
  EXPECT_TRUE(json_of(out / "still.json").at(0)["update_ms"].is_null());
}

TEST_F(CompareTest, AnInterruptEndsCleanlyAndResumeGoesOn) {
  Tool tool(with(plan, {"--warmup", "8"}));
  wait_for_lines(4);
  tool.signal(SIGINT);
  EXPECT_EQ(tool.wait(), 130);
  EXPECT_NE(tool.err().find("--resume"), std::string::npos);
  const std::size_t measured = lines();
  EXPECT_GE(measured, 4u);
  ASSERT_LT(measured, 25u);
  EXPECT_GE(json_of(out / "compare.json").size(), 1u);

  Tool other(with(plan, {"--resume", "--task-size", "64"}));
  EXPECT_EQ(other.wait(), 2);
  EXPECT_NE(other.err().find("task_size: 256 before, 64 now"), std::string::npos) << other.err();
  Tool smaller(with({"compare", "--resume", "--out", out}, {"--size", "40x48"}));
  EXPECT_EQ(smaller.wait(), 2);
  EXPECT_EQ(lines(), measured);

  Tool rest({"compare", "--resume", "--out", out});
  EXPECT_EQ(rest.wait(), 0) << rest.err();
  expect_complete();
}

TEST_F(CompareTest, AKilledRunCanBeResumedDespiteATornLine) {
  Tool tool(with(plan, {"--warmup", "8"}));
  wait_for_lines(3);
  tool.signal(SIGKILL);
  EXPECT_EQ(tool.wait(), 1000 + SIGKILL);
  std::ofstream(out / "runs.jsonl", std::ios::app) << "{\"queue\":\"lo";
  Tool rest({"compare", "--resume", "--out", out});
  EXPECT_EQ(rest.wait(), 0) << rest.err();
  expect_complete();
}

TEST_F(CompareTest, OtherConditionsAreNotMixedIn) {
  Tool tool(plan);
  ASSERT_EQ(tool.wait(), 0) << tool.err();
  std::string text = contents(out / "runs.jsonl");
  const std::string key = "\"compiler\":\"";
  text.insert(text.find(key) + key.size(), "another ");
  std::ofstream(out / "runs.jsonl") << text;
  expect_one_line({"compare", "--resume", "--out", out}, "compiler");
}

TEST(Tool, TooManyThreadsForTheSystemIsOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's shadow does not fit into a limited address space";
#endif
  // A limit on address space stands for a system that refuses threads; each wants 8 MB of stack.
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  const rlimit tight{3'000'000'000, before.rlim_max};
  setrlimit(RLIMIT_AS, &tight);
  Tool tool(render({"--threads", "1024"}));
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(tool.wait(), 2);
  EXPECT_EQ(std::ranges::count(tool.err(), '\n'), 1) << tool.err();
}

}  // namespace
}  // namespace irt::frames
