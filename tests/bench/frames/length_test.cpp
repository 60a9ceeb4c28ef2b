// How long a measurement takes. It is planned from a few frames at its beginning, so nothing else
// may run beside it: among busy processes a small frame takes 0.3 ms one moment, and 4 the next.
#include <chrono>
#include <gtest/gtest.h>

#include "tests/bench/running_tool.hpp"

namespace irt::frames {
namespace {

TEST(Length, OfASmallSceneIsWhatWasAskedFor) {
  const TemporaryDirectory directory;
  const auto begin = std::chrono::steady_clock::now();
  RunningTool tool(IRT_FRAMES, {"compare", "--scene", "office", "--size", "16x16", "--queue",
                                "lock", "--threads", "1", "--repetitions", "2", "--seconds", "8",
                                "--out", directory / "out"});
  EXPECT_EQ(tool.wait(), 0) << tool.err();
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
}

}  // namespace
}  // namespace irt::frames
