// What is left of a measurement that its user has ended.
#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <thread>

#include "tests/bench/running_tool.hpp"

namespace irt::frames {
namespace {

TEST(Interrupt, LeavesPicturesWhole) {
  const TemporaryDirectory directory;
  const auto office = [](Arguments more) {
    more.insert(more.begin(), {"render", "--scene", "office", "--size", "200x200"});
    return more;
  };
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  RunningTool whole(IRT_FRAMES, office({"--frames", "1", "--image", directory / "whole.png"}));
  ASSERT_EQ(whole.wait(), 0) << whole.err();
  const auto one_frame = Clock::now() - begin;
  RunningTool tool(IRT_FRAMES, office({"--frames", "1000000", "--image", directory / "a.png",
                                       "--json", directory / "a.json"}));
  std::this_thread::sleep_for(std::chrono::seconds(1) + 3 * one_frame);  // some frames are done
  tool.signal(SIGINT);
  EXPECT_EQ(tool.wait(), 130) << tool.err();
  EXPECT_EQ(contents(directory / "a.png"), contents(directory / "whole.png"));
  const auto run = json_of(directory / "a.json").at(0);
  EXPECT_EQ(run["status"], "interrupted");
  EXPECT_GT(run["fps"], 0);
  EXPECT_TRUE(run["share_traverse"].is_null() && run["share_intersect"].is_null());
}

TEST(Interrupt, BeforeAnythingIsMeasuredIsOneLine) {
  const TemporaryDirectory directory;
  RunningTool tool(IRT_FRAMES,
                   {"compare", "--scene", "office", "--size", "16x16", "--queue", "lock",
                    "--threads", "1", "--frames", "1000000", "--out", directory / "out"});
  // Until the first frame is there, and the endless repetition has begun.
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (tool.err().find("first frame after") == std::string::npos) {
    ASSERT_LT(std::chrono::steady_clock::now(), patience) << tool.err();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  tool.signal(SIGINT);
  EXPECT_EQ(tool.wait(), 130) << tool.err();
  EXPECT_NE(tool.err().find("interrupted before anything was measured"), std::string::npos)
      << tool.err();
  EXPECT_EQ(tool.out(), "");
}

}  // namespace
}  // namespace irt::frames
