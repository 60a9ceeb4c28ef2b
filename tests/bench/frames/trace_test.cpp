// The trace: well formed, spans nest, and nothing of a frame is missing.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/frames/trace_file.hpp"
#include "tests/bench/temporary.hpp"

namespace irt::frames {
namespace {

struct Event {
  std::string name;
  double begin, end;  // microseconds
};
using Rows = std::map<int, std::vector<Event>>;  // by thread

constexpr double rounding = 0.002;

nlohmann::json read(const std::filesystem::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in);
}

Rows rows_of(const nlohmann::json& trace) {
  Rows rows;
  for (const auto& event : trace.at("traceEvents")) {
    if (event.at("ph") != "X") continue;
    const double begin = event.at("ts"), time = event.at("dur");
    EXPECT_GE(begin, 0);
    EXPECT_GE(time, 0);
    rows[event.at("tid")].push_back({event.at("name"), begin, begin + time});
  }
  return rows;
}

// Each span begins after the one before it, and lies wholly inside or wholly outside of every
// other.
void expect_nested(const std::vector<Event>& row) {
  std::vector<Event> open;
  double last = 0;
  for (const Event& event : row) {
    EXPECT_GE(event.begin, last);
    last = event.begin;
    while (!open.empty() && event.begin >= open.back().end - rounding) open.pop_back();
    if (!open.empty()) {
      ASSERT_LE(event.end, open.back().end + rounding)
          << event.name << " leaves " << open.back().name;
    }
    open.push_back(event);
  }
}

double inside(const std::vector<Event>& row, const Event& frame, bool outermost) {
  double sum = 0, covered = frame.begin;
  for (const Event& event : row) {
    if (outermost && event.begin < covered - rounding) continue;
    const double begin = std::max(event.begin, frame.begin), end = std::min(event.end, frame.end);
    if (end <= begin) continue;
    sum += end - begin;
    covered = end;
  }
  return sum;
}

class TraceTest : public testing::Test {
 protected:
  nlohmann::json trace(const std::string& options) {
    const std::string command = std::string(IRT_FRAMES) + " render --scene office --size 64x64 " +
                                options + " --trace " + file_.string() + " --json " +
                                (directory_ / "run.json").string() + " > /dev/null 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return read(file_);
  }

  TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "trace.json";
};

TEST_F(TraceTest, EveryMomentOfEveryThreadIsAccountedForAndSpansNest) {
  for (const char* termination : {"outstanding-count", "leave-when-empty"}) {
    const auto document = trace(
        "--queue lfree --threads 3 --frames 3 --warmup 1 --task-size 16 "
        "--termination " +
        std::string(termination));
    EXPECT_EQ(document.at("otherData").at("dropped_spans"), 0);
    EXPECT_EQ(document.at("otherData").at("threads"), 3);
    const Rows rows = rows_of(document);
    ASSERT_EQ(rows.size(), 4u);
    std::vector<Event> loops;
    std::size_t frames = 0;
    for (const Event& event : rows.at(3)) {
      if (event.name == "render") loops.push_back(event);
      frames += event.name == "frame" ? 1 : 0;
    }
    EXPECT_EQ(loops.size(), 3u);
    EXPECT_EQ(frames, 3u);
    for (const auto& [thread, row] : rows) expect_nested(row);
    for (int thread = 0; thread < 3; ++thread) {
      for (const Event& loop : loops) {
        const double whole = loop.end - loop.begin;
        // A thread that comes late from the barrier is at the barrier until then.
        EXPECT_NEAR(inside(rows.at(thread), loop, true), whole, 0.01 * whole + 1);
      }
    }
  }
}

TEST_F(TraceTest, ItHoldsTheTasksThatTheFiguresCount) {
  const auto document = trace("--queue lock --threads 2 --frames 2 --warmup 0 --task-size 16");
  const double per_frame = read(directory_ / "run.json").at(0).at("tasks_per_frame");
  std::map<std::string, std::size_t> count;
  for (const auto& [thread, row] : rows_of(document)) {
    for (const Event& event : row) ++count[event.name];
  }
  const std::size_t tasks = count["primary task"] + count["shadow task"] + count["specular task"];
  EXPECT_EQ(static_cast<double>(tasks), 2 * per_frame);
  EXPECT_EQ(count["get"], tasks);
  EXPECT_EQ(count["trace"], tasks);
  EXPECT_EQ(count["shade"], tasks);
  EXPECT_GT(count["shadow task"], 0u);
}

TEST_F(TraceTest, MemoryIsBoundedAndWhatDoesNotFitIsCounted) {
  TraceLog log(1, 10);
  const auto now = std::chrono::steady_clock::now();
  for (int i = 0; i < 25; ++i) {
    const auto begin = now + std::chrono::microseconds(10 * i);
    log.add(
        0,
        {.begin = begin, .end = begin + std::chrono::microseconds(5), .activity = Activity::get});
  }
  write_trace(file_, log, {{"queue", "a \"quoted\" name"}});
  const auto document = read(file_);
  EXPECT_EQ(document.at("otherData").at("dropped_spans"), 15);
  EXPECT_EQ(document.at("otherData").at("queue"), "a \"quoted\" name");
  EXPECT_EQ(rows_of(document).at(0).size(), 10u);
}

TEST_F(TraceTest, PushesThatFollowEachOtherAreOneSpan) {
  TraceLog log(1, 10);
  const auto now = std::chrono::steady_clock::now();
  for (int i = 0; i < 4; ++i) {
    log.add(0, {.begin = now + std::chrono::nanoseconds(100 * i),
                .end = now + std::chrono::nanoseconds(100 * (i + 1)),
                .activity = Activity::add});
  }
  ASSERT_EQ(log.spans(0).size(), 1u);
  EXPECT_EQ(log.spans(0)[0].count, 4u);
  EXPECT_EQ(log.spans(0)[0].end - log.spans(0)[0].begin, std::chrono::nanoseconds(400));
}

}  // namespace
}  // namespace irt::frames
