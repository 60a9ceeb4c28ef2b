#include "bench/frames/summary.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <span>

#include "tests/bench/fields.hpp"

namespace irt::frames {
namespace {

Sample sample(const std::string& queue, unsigned threads, std::vector<double> seconds) {
  Sample one;
  one.queue = queue;
  one.threads = threads;
  one.seconds = std::move(seconds);
  const auto frames = static_cast<double>(one.seconds.size());
  one.generate_s = 0.1 * frames;
  one.render_s = 0.8 * frames;
  one.output_s = 0.1 * frames;
  one.trace_s = 0.4 * frames * threads;
  one.shade_s = 0.2 * frames * threads;
  one.barrier_s = 0.004 * frames * threads;
  one.get_s = 1e-6 * frames;
  one.gets = {0, 0, 3, 0, 1};  // three times 2 ns, once 4 ns
  one.tasks = 100 * one.seconds.size();
  one.rays = 1000 * one.seconds.size();
  one.imbalance = frames;
  one.image_hash = "f";
  return one;
}

TEST(Summary, WritesTheFieldsOfItsTool) {
  const auto runs = summarise(std::vector{sample("lock", 1, {0.5})}, std::vector<Background>(1));
  EXPECT_EQ(keys_of(runs[0]), fields_by(results::by_render));
}

TEST(Summary, ACrashIsARunAndLeavesWhatWasMeasured) {
  Sample crash = sample("lock", 1, {}), hang = sample("lock", 2, {});
  crash.status = "crashed";
  crash.message = "Aborted";
  hang.status = "hung";
  const std::vector<Sample> samples{crash, sample("lock", 1, {0.5, 0.5}), hang};
  const auto runs = summarise(samples, std::vector<Background>(1));
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["status"], "crashed");
  EXPECT_EQ(runs[0]["message"], "Aborted");
  EXPECT_DOUBLE_EQ(runs[0]["fps"].get<double>(), 2);
  EXPECT_EQ(runs[0]["repetitions"], 1);
  EXPECT_EQ(runs[0]["same_image"], true);
  EXPECT_EQ(runs[1]["status"], "hung");
  EXPECT_TRUE(runs[1]["fps"].is_null());
  EXPECT_TRUE(runs[1]["same_image"].is_null());
  EXPECT_NE(table(runs).find("crashed: Aborted"), std::string::npos);
}

TEST(Summary, FiguresAreThoseOfTheThesis) {
  const std::vector<Sample> samples{sample("lock", 1, {1.0, 1.0}), sample("lock", 2, {0.5}),
                                    sample("local", 1, {2.0}), sample("lock", 1, {0.5, 1.0}),
                                    sample("local", 2, {})};
  std::vector<Background> background(1);
  background[0].triangles = 12;
  background[0].traverse_share = 0.75;
  const auto runs = summarise(samples, background);
  ASSERT_EQ(runs.size(), 3u);  // without the empty one
  const auto& one = runs[0];
  EXPECT_EQ(one["queue"], "lock");
  EXPECT_EQ(one["repetitions"], 2);
  EXPECT_EQ(one["frames"], 4);
  EXPECT_EQ(one["triangles"], 12);
  EXPECT_DOUBLE_EQ(one["fps"].get<double>(), 1);
  EXPECT_DOUBLE_EQ(one["rays_per_frame"].get<double>(), 1000);
  EXPECT_DOUBLE_EQ(one["rays_per_second"].get<double>(), 1000);
  EXPECT_DOUBLE_EQ(one["share_render_loop"].get<double>(), 0.8);
  EXPECT_NEAR(one["share_traverse"].get<double>(), 0.375, 1e-12);
  EXPECT_NEAR(one["share_intersect"].get<double>(), 0.125, 1e-12);
  EXPECT_NEAR(one["share_shade"].get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(one["get_ns_mean"].get<double>(), 10, 1e-9);
  EXPECT_EQ(one["get_ns"], 2);
  EXPECT_EQ(one["get_ns_p99"], 4);
  EXPECT_NEAR(one["barrier_wait_ms"].get<double>(), 4, 1e-9);
  EXPECT_DOUBLE_EQ(runs[1]["speed_up"].get<double>(), 2);
  EXPECT_DOUBLE_EQ(runs[2]["speed_up"].get<double>(), 0.5);
  EXPECT_TRUE(summarise(std::span(&samples[1], 1), background)[0]["speed_up"].is_null());
}

TEST(Summary, AStutterIsSeenThatTheMedianHides) {
  std::vector<double> seconds(200, 0.01);
  std::ranges::fill(std::span(seconds).first(3), 0.5);
  const auto runs = summarise(std::vector{sample("lock", 1, seconds)}, std::vector<Background>(1));
  EXPECT_DOUBLE_EQ(runs[0]["fps"].get<double>(), 100);
  EXPECT_DOUBLE_EQ(runs[0]["frame_ms_p99"].get<double>(), 500);
}

TEST(Summary, ADifferentHashInOneRepetitionIsSeen) {
  std::vector<Sample> samples{sample("lock", 1, {1.0}), sample("lock", 1, {1.0})};
  EXPECT_TRUE(summarise(samples, std::vector<Background>(1))[0]["same_image"].get<bool>());
  samples[1].image_hash = "e";
  EXPECT_FALSE(summarise(samples, std::vector<Background>(1))[0]["same_image"].get<bool>());
}

TEST(Summary, WorkloadsAreRunsOfTheirOwnAndTheTableShowsWhereTheyDiffer) {
  std::vector<Sample> samples{sample("lock", 1, {1.0}), sample("lock", 1, {0.5}),
                              sample("-", 2, {0.25})};
  samples[1].workload = 1;
  samples[2].workload = 2;
  std::vector<Background> backgrounds(3);
  backgrounds[0].workload.bvh = "wald";
  backgrounds[1].workload.bvh = backgrounds[2].workload.bvh = "wide";
  backgrounds[2].workload.packet_width = 8;
  const auto runs = summarise(samples, backgrounds);
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0]["bvh"], "wald");
  EXPECT_EQ(runs[1]["speed_up"], 1);  // not against the other workload
  EXPECT_TRUE(runs[0]["packet_width"].is_null());
  EXPECT_EQ(runs[2]["packet_width"], 8);
  EXPECT_TRUE(runs[2]["queue"].is_null());
  EXPECT_TRUE(runs[2]["get_ns"].is_null());
  const std::string lines = table(runs);
  EXPECT_EQ(std::ranges::count(lines, '\n'), 4);
  EXPECT_TRUE(lines.starts_with("bvh   packet  queue  threads")) << lines;
  EXPECT_NE(lines.find("wide  8       -            2     4.00"), std::string::npos) << lines;
  EXPECT_TRUE(table(summarise(std::span(&samples[0], 1), backgrounds)).starts_with("queue  thr"));
}

TEST(Summary, CsvHasALineOfNamesAndALinePerRun) {
  const auto text =
      csv(summarise(std::vector{sample("lock", 1, {1.0})}, std::vector<Background>(1)));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2);
  const auto names = text.substr(0, text.find('\n'));
  EXPECT_EQ(std::ranges::count(text, ','), 2 * std::ranges::count(names, ','));
  EXPECT_EQ(names.find("conditions"), std::string::npos);
}

}  // namespace
}  // namespace irt::frames
