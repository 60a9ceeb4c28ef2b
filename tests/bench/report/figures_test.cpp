// Which runs come into which figure, and the plots for papers.
#include "bench/report/figures.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "bench/report/plots.hpp"
#include "tests/bench/report/synthetic.hpp"
#include "tests/bench/temporary.hpp"

namespace irt::report {
namespace {

using synthetic::Json;

using Names = std::vector<std::string>;

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

class FiguresTest : public testing::Test {
 protected:
  Results read(const Json& runs) {
    std::ofstream(directory_ / "runs.json") << runs;
    const std::vector<std::filesystem::path> places{directory_ / "runs.json"};
    return read_results(places);
  }
  static const Panel& panel(const std::vector<Panel>& panels, const std::string& title) {
    for (const Panel& one : panels) {
      if (one.title == title) return one;
    }
    throw std::runtime_error("no panel " + title);
  }
  static const Plot& plot(const Panel& panel, const std::string& name) {
    for (const Plot& one : panel.plots) {
      if (one.name == name) return one;
    }
    throw std::runtime_error("no plot " + name);
  }
  static std::vector<std::string> names(const Panel& panel) {
    std::vector<std::string> all;
    for (const Series& series : panel.series) all.push_back(series.name);
    return all;
  }

  TemporaryDirectory directory_;
};

TEST_F(FiguresTest, QueuesOverThreadsWithIntervalsAndSamples) {
  const auto panels = panels_of(read(synthetic::sweep({"lock", "lfree"}, {4, 1, 2})));
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_EQ(panels[0].title, "pairs, over threads");
  EXPECT_EQ(names(panels[0]), (Names{"lock", "lfree"}));
  const Plot& operations = plot(panels[0], "operations_per_second");
  ASSERT_EQ(operations.lines.size(), 2u);
  ASSERT_EQ(operations.lines[0].size(), 3u);
  const Point& first = operations.lines[0][0];
  EXPECT_EQ(first.x, 1);
  EXPECT_EQ(first.y, 4e6);
  EXPECT_NEAR(*first.low, 3.72e6, 1);
  EXPECT_EQ(first.samples.size(), 3u);
  // What no run has, and what is 0 everywhere, is no plot.
  for (const Plot& one : panels[0].plots) {
    EXPECT_NE(one.name, "energy_joules");
    EXPECT_NE(one.name, "failed_pushes_per_second");
  }
}

TEST_F(FiguresTest, LevelsOfASimulatedMachineAreMarkedWhereTheyAreInRange) {
  Json runs = synthetic::sweep({"lock"}, {1, 64}, "big");
  for (Json& run : runs) {
    run["levels"] = {{{"threads", 8}, {"name", "one cache"}},
                     {{"threads", 64}, {"name", "a core each"}},
                     {{"threads", 128}, {"name", "all hardware threads"}},
                     {{"threads", nullptr}, {"name", "nothing"}}};
  }
  const auto panels = panels_of(read(runs));
  const Plot& operations = plot(panels[0], "operations_per_second");
  ASSERT_EQ(operations.marks.size(), 2u);
  EXPECT_EQ(operations.marks[0].x, 8);
  EXPECT_EQ(operations.marks[0].name, "one cache");
  EXPECT_EQ(operations.marks[1].x, 64);
  write_plots(panels, directory_ / "plots");
  const std::string script =
      contents(directory_ / "plots" / (panels[0].name + "-operations_per_second.gp"));
  EXPECT_NE(script.find("set label 'one cache' at 8,"), std::string::npos) << script;
}

TEST_F(FiguresTest, SimulatedRunsStandBesideMeasuredOnesAndAreMarked) {
  Json runs = synthetic::sweep({"lock"}, {1, 2, 4});
  for (const Json& run : synthetic::sweep({"lock"}, {1, 64, 256}, "big")) runs.push_back(run);
  const auto panels = panels_of(read(runs));
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_EQ(names(panels[0]), (Names{"lock", "lock, simulated big"}));
  EXPECT_FALSE(panels[0].series[0].simulated);
  EXPECT_TRUE(panels[0].series[1].simulated);
  EXPECT_EQ(panels[0].series[0].colour, panels[0].series[1].colour);
  EXPECT_EQ(panels[0].facts[0].value, "measured; simulated");
  EXPECT_TRUE(plot(panels[0], "operations_per_second").log_x);
}

TEST_F(FiguresTest, SimulatedFramesStandBesideMeasuredOnes) {
  Json runs =
      Json::array({synthetic::frames("lock", 1, 256, 9), synthetic::frames("lock", 2, 256, 17)});
  for (const unsigned threads : {1U, 64U}) {
    Json run{{"kind", "simulated"}, {"source", "simulated"}, {"machine", "big"},
             {"queue", "lock"},     {"scene", "office"},     {"scenario", "renderer"},
             {"threads", threads},  {"task_size", 256},      {"packet_width", 0},
             {"fps", 8.0 * threads}};
    run["conditions"] = synthetic::conditions();
    runs.push_back(run);
  }
  const auto panels = panels_of(read(runs));
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_EQ(names(panels[0]).front(), "lock");
  EXPECT_TRUE(names(panels[0]).back().starts_with("lock, simulated big"));
  EXPECT_EQ(plot(panels[0], "fps").lines[1].size(), 2u);
}

TEST_F(FiguresTest, ASweepOverTheSpreadOfTheWorkIsAFigure) {
  Json runs = Json::array();
  for (const double spread : {0.0, 0.5, 1.0}) {
    for (const char* queue : {"lock", "lfree"}) {
      Json run = synthetic::operations(queue, 2, 1e6 * (2 - spread));
      run["work_spread"] = spread;
      runs.push_back(run);
    }
  }
  const auto panels = panels_of(read(runs));
  ASSERT_EQ(panels.size(), 1u);
  EXPECT_EQ(panels[0].title, "pairs, over spread of the work");
  EXPECT_EQ(plot(panels[0], "operations_per_second").lines[1].size(), 3u);
}

// What tasks take follows from their size, unless it was asked for.
TEST_F(FiguresTest, TheMeanTaskIsAnAxisOnlyWhereItIsAChoice) {
  Json asked = Json::array(), follows = Json::array();
  for (const unsigned threads : {1U, 64U}) {
    for (const unsigned factor : {1U, 4U}) {
      Json run = synthetic::frames("lock", threads, 64, 9.0 * threads / factor);
      run.update({{"kind", "simulated"}, {"source", "simulated"}, {"machine", "big"}});
      run["mean_task_us"] = 20.5 * factor;
      asked.push_back(run);
      run["task_size"] = 64 * factor;
      follows.push_back(run);
    }
  }
  const auto panels = panels_of(read(asked));
  EXPECT_EQ(plot(panel(panels, "office, over mean task"), "fps").lines[0].size(), 2u);
  for (const Panel& one : panels_of(read(follows))) {
    EXPECT_NE(one.title, "office, over mean task");
  }
}

TEST_F(FiguresTest, PicturesOfOneWidthAreToldApartByTheirHeight) {
  Json runs = Json::array();
  for (const unsigned height : {300U, 600U}) {
    for (const unsigned threads : {1U, 2U}) {
      Json run = synthetic::frames("lock", threads, 256, 9.0 * threads);
      run["width"] = 300;
      run["height"] = height;
      runs.push_back(run);
    }
  }
  EXPECT_EQ(names(panels_of(read(runs))[0]), (Names{"lock, height 300", "lock, height 600"}));
}

TEST_F(FiguresTest, TaskSizesAreAFigureOfTheirOwn) {
  Json runs = Json::array();
  for (const unsigned size : {1U, 16U, 256U}) {
    for (const unsigned threads : {1U, 2U}) {
      for (const char* queue : {"lock", "lfree"}) {
        runs.push_back(synthetic::frames(queue, threads, size, 10.0 * threads + size / 100.0));
      }
    }
  }
  const auto panels = panels_of(read(runs));
  const Panel& sizes = panel(panels, "office, over task size");
  EXPECT_EQ(names(sizes),
            (Names{"lock, threads 1", "lfree, threads 1", "lock, threads 2", "lfree, threads 2"}));
  EXPECT_EQ(plot(sizes, "fps").lines[0].size(), 3u);
  const Plot& queue_time = plot(panel(panels, "office, over threads"), "get_ns_mean");
  EXPECT_EQ(queue_time.lines[0][0].y, 150 + 20 + 80 + 10);
}

TEST_F(FiguresTest, TooManyLinesBecomeVariants) {
  Json runs = Json::array();
  for (const char* placement : {"close", "far", "smt-first"}) {
    for (Json& run : synthetic::sweep({"a", "b", "c", "d"}, {1, 2})) {
      run["placement"] = placement;
      runs.push_back(std::move(run));
    }
  }
  const auto panels = panels_of(read(runs));
  ASSERT_EQ(panels.size(), 3u);
  EXPECT_EQ(panels[1].title, panels[0].title);
  EXPECT_EQ(panels[1].variant, "far");
  EXPECT_EQ(panels[1].series.size(), 4u);
}

TEST_F(FiguresTest, NoLineHasTwoPointsAtOnePlace) {
  // Producers and consumers usually follow from scenario and threads. Here they do not.
  Json runs = Json::array();
  for (const auto& [producers, consumers] : {std::pair(1, 7), std::pair(4, 4), std::pair(7, 1)}) {
    for (const unsigned work : {0U, 100U}) {
      Json run = synthetic::operations("lock", 8, 1e6 * producers);
      run["producers"] = producers;
      run["consumers"] = consumers;
      run["work_ns"] = work;
      runs.push_back(run);
    }
  }
  for (const Panel& panel : panels_of(read(runs))) {
    for (const Plot& plot : panel.plots) {
      for (const auto& line : plot.lines) {
        EXPECT_EQ(std::ranges::adjacent_find(line, {}, &Point::x), line.end()) << panel.title;
      }
    }
  }
}

TEST_F(FiguresTest, SingleOperationsStandBesideEachOtherByWhatTheyDo) {
  std::ofstream(directory_ / "micro.json") << synthetic::micro(
      {"lock/push", "lfree/push", "lock/pop/threads:2", "BM_copy/8", "BM_copy<int>", "alone"});
  const std::vector<std::filesystem::path> places{directory_ / "micro.json"};
  const auto panels = panels_of(read_results(places));
  EXPECT_EQ(names(panel(panels, "push")), (Names{"lock", "lfree"}));
  EXPECT_EQ(names(panel(panels, "pop")), (Names{"lock/threads:2"}));
  EXPECT_EQ(names(panel(panels, "BM_copy")), (Names{"8", "int"}));
  EXPECT_EQ(names(panel(panels, "alone")), (Names{"alone"}));
}

TEST_F(FiguresTest, EveryFactStandsBesideAFigure) {
  const auto panels = panels_of(read(synthetic::sweep({"lock"}, {1, 2})));
  std::string said;
  for (const Fact& fact : panels[0].facts) said += fact.name + "=" + fact.value + "\n";
  const auto columns = series_columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    said += columns[i] + "=" + panels[0].series[0].facts[i] + "\n";
  }
  for (const char* part :
       {"source=measured\n", "operation mix=push, then pop\n", "work between operations=50 ns\n",
        "placement=close\n", "SMT=64 hardware threads on 32 cores\n", "governor=performance\n",
        "interval=95 % of the mean", "repetitions=5\n", "processor=Imaginary 9000\n",
        "compiler=GNU 12.2.0, -O2\n", "commit=0123456789ab\n", "ordering=FIFO in real time\n",
        "progress=lock-free\n", "bound=unbounded\n", "reclaimer=hazard pointers\n",
        "allocator=glibc malloc\n", "failed operations=1e+05 to", "status=ok\n"}) {
    EXPECT_PRED_FORMAT2(testing::IsSubstring, part, said);
  }
}

TEST_F(FiguresTest, WhatIsNotThereIsNotInvented) {
  Json run = synthetic::operations("a-plug-in", 1, 1e6);
  for (const char* key : {"claims", "allocator", "operation_mix", "work_ns",
                          "failed_pops_per_second", "failed_pushes_per_second", "conditions"}) {
    run.erase(key);
  }
  const auto panels = panels_of(read(Json::array({run})));
  const Series& series = panels.at(0).series.at(0);
  EXPECT_EQ(series.facts[0], not_recorded);
  EXPECT_EQ(series.facts[4], not_recorded);
  EXPECT_EQ(series.facts[5], not_measured);
  EXPECT_EQ(panels[0].facts[7].value, "5");
  EXPECT_EQ(panels[0].facts[8].value, not_recorded);
}

TEST_F(FiguresTest, PlotsForPapersHoldTheirDataAndExecuteNothing) {
  Json runs =
      synthetic::sweep({"lock", "it's `touch pwned` \"$(touch pwned)\"\nset output"}, {1, 4, 16});
  runs[1]["operations_per_second_low"] = nullptr;
  const auto plots = directory_ / "plots";
  const PlotsWritten written = write_plots(panels_of(read(runs)), plots);
  EXPECT_GE(written.count, 4u);
  const auto base = plots / "operations-pairs-over-threads-operations_per_second";
  const std::string data = contents(base.string() + ".dat");
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "\n1 4000000 3720000 4280000\n", data);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, " ? ", data);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "# governor: performance", data);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "ordering: FIFO in real time",
                      contents(base.string() + ".txt"));
  if (!written.drawn) GTEST_SKIP() << "gnuplot is not installed: the plots were not drawn";
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "</svg>", contents(base.string() + ".svg"));
  EXPECT_TRUE(contents(base.string() + ".pdf").starts_with("%PDF-"));
  EXPECT_FALSE(std::filesystem::exists(plots / "pwned"));
}

TEST_F(FiguresTest, SimulatedLinesOfAPaperAreDashed) {
  Json runs = synthetic::sweep({"lock"}, {1, 4});
  for (const Json& run : synthetic::sweep({"lock"}, {1, 64}, "big")) runs.push_back(run);
  write_plots(panels_of(read(runs)), directory_ / "plots");
  const std::string script =
      contents(directory_ / "plots/operations-pairs-over-threads-operations_per_second.gp");
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "dt 1 title 'lock'", script);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "dt 2 title 'lock, simulated big'", script);
}

}  // namespace
}  // namespace irt::report
