/// `irt simulate` as a user runs it.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/bench/running_tool.hpp"

namespace irt {
namespace {

namespace fs = std::filesystem;

class SimulateTest : public testing::Test {
 protected:
  [[nodiscard]] Arguments sweep(const std::string& queues) const {
    return {"--machine", "granite-rapids-96", "--queue", queues,  "--cores", "1,2", "--time",
            "0.02",      "--seeds",           "2",       "--out", out_};
  }
  [[nodiscard]] nlohmann::json runs() const { return json_of(out_ / "simulate.json"); }

  TemporaryDirectory directory_;
  fs::path out_ = directory_ / "out";
};

TEST_F(SimulateTest, BaselinesThatCarryNothingAreSimulated) {
  RunningTool tool(IRT_SIMULATE, sweep("faa,cas,delay"));
  EXPECT_EQ(tool.wait(), 0) << tool.out();
  for (const auto& run : runs()) EXPECT_EQ(run["status"], "ok") << run["message"];
}

TEST_F(SimulateTest, EveryQueueHasItsHottestLines) {
  RunningTool tool(IRT_SIMULATE, sweep("lock,lfree"));
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  for (const char* queue : {"lock", "lfree"}) {
    EXPECT_NE(tool.out().find(std::string("hottest lines of ") + queue + ", 2"), std::string::npos)
        << tool.out();
  }
  // Whichever seed was done first.
  for (const auto& run : runs()) EXPECT_FALSE(run["hot_lines"].is_null());
}

TEST_F(SimulateTest, AsksOnceForAllPlacesOfTheHottestLines) {
  const fs::path asked = directory_ / "asked", fake = directory_ / "addr2line";
  const std::string path = std::getenv("PATH");
  std::ofstream(fake) << "#!/bin/sh\necho >>" << asked.string() << "\nPATH='" << path
                      << "' exec addr2line \"$@\"\n";
  fs::permissions(fake, fs::perms::owner_all);
  setenv("PATH", (fake.parent_path().string() + ":" + path).c_str(), 1);
  RunningTool tool(IRT_SIMULATE, {"--machine", "granite-rapids-96", "--queue", "lfree", "--cores",
                                  "8", "--time", "0.02", "--seeds", "1", "--out", out_});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  const auto lines = runs().at(0)["hot_lines"];
  EXPECT_GT(lines.size(), 1U);
  EXPECT_NE(lines.at(0)["sites"].at(0)["source"], "");
  EXPECT_EQ(contents(asked), "\n");
}

TEST_F(SimulateTest, AModuleThatDoesNotLoadEndsNoSweep) {
  std::ofstream(directory_ / "broken.virtual.so") << "no module";
  Arguments arguments = sweep("broken,lock");
  arguments.insert(arguments.end(), {"--plugin", (directory_ / "broken.so").string()});
  RunningTool tool(IRT_SIMULATE, arguments);
  EXPECT_EQ(tool.wait(), 1) << tool.err();
  ASSERT_EQ(runs().size(), 4u);
  for (const auto& run : runs()) {
    EXPECT_EQ(run["status"], run["queue"] == "lock" ? "ok" : "failed") << run["message"];
  }
}

TEST_F(SimulateTest, OneThatWasKilledWhileItWroteGoesOn) {
  EXPECT_EQ(RunningTool(IRT_SIMULATE, sweep("lock")).wait(), 0);
  nlohmann::json before = runs();
  const fs::path journal = out_ / "simulate.journal";
  const auto whole = fs::file_size(journal);
  fs::resize_file(journal, whole - 10);
  for (int round = 0; round < 2; ++round) {
    Arguments arguments = sweep("lock");
    arguments.emplace_back("--resume");
    RunningTool tool(IRT_SIMULATE, arguments);
    EXPECT_EQ(tool.wait(), 0) << tool.err();
    nlohmann::json now = runs();
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_EQ(now[i]["samples"], before[i]["samples"]);
    }
    const std::string text = contents(journal);  // a header and two seeds at two points
    EXPECT_EQ(std::ranges::count(text, '\n'), 5);
  }
}

TEST_F(SimulateTest, FiguresOnStandardOutputAreAlone) {
  Arguments arguments = sweep("lock");
  arguments.insert(arguments.end(), {"--json", "-"});
  RunningTool tool(IRT_SIMULATE, arguments);
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  EXPECT_EQ(nlohmann::json::parse(tool.out(), nullptr, false).size(), 2u) << tool.out();
}

TEST_F(SimulateTest, NothingIsNoValue) {
  for (const char* option : {"--queue", "--out", "--machine"}) {
    RunningTool tool(IRT_SIMULATE, {option, ""});
    EXPECT_EQ(tool.wait(), 2);
    EXPECT_NE(tool.err().find(std::string(option) + ": nothing"), std::string::npos) << tool.err();
  }
}

TEST_F(SimulateTest, RefusesGapsInListsAndDepthsThatNoShaderTakes) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{"--queue", "lock,"}, "--queue lock,: number 2 of the list is empty; write --queue lock\n"},
      {{"--renderer", "--task-size", ",8"}, "write --task-size 8\n"},
      {{"--renderer", "--shader", "normals", "--depth", "4"}, "--shader whitted has\n"}};
  for (const auto& [arguments, said] : mistakes) {
    RunningTool tool(IRT_SIMULATE, arguments);
    EXPECT_EQ(tool.wait(), 2);
    EXPECT_TRUE(tool.err().ends_with(said)) << tool.err();
  }
}

}  // namespace
}  // namespace irt
