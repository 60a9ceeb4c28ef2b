// What is read, what is refused and how, and how files are merged.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "bench/contention/summary.hpp"
#include "bench/report/results.hpp"
#include "tests/bench/fields.hpp"
#include "tests/bench/report/synthetic.hpp"
#include "tests/bench/temporary.hpp"

namespace irt::report {
namespace {

using synthetic::Json;

class ReadingTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }
  static Results read(const std::vector<std::filesystem::path>& places) {
    return read_results(places);
  }
  // The line that a reader gets for a file which cannot be read.
  std::string refusal(const std::string& text, const std::string& name = "a.json") {
    const auto file = write(name, text);
    try {
      read({file});
    } catch (const ResultError& error) {
      std::string said = error.what();
      EXPECT_TRUE(said.starts_with(file.string())) << said;
      EXPECT_EQ(std::ranges::count(said, '\n'), 0) << said;
      return said;
    }
    ADD_FAILURE() << "accepted: " << text;
    return {};
  }

  TemporaryDirectory directory_;
};

TEST_F(ReadingTest, BadFilesAreOneLineThatNamesTheFile) {
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "empty", refusal(""));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "empty", refusal(" \n"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "no runs", refusal("[]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "array of runs", refusal("{}"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "not JSON", refusal("hello"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "ends in the middle",
                      refusal("[{\"kind\": \"contention\"}, {"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "number", refusal("[1e999]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "not JSON", refusal("[\"\xff\"]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "run 1", refusal("[7]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "'kind'", refusal("[{\"a\": 1}]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "'kind'", refusal("[{\"kind\": 7}]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "contention", refusal("[{\"kind\": \"contentoin\"}]"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "missing",
                      refusal("{\"context\": 1, \"benchmarks\": [{}]}"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "missing",
                      refusal("{\"format\":\"irt-frames 3\"}\n", "a.jsonl"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "line 1", refusal("nonsense\n", "a.jsonl"));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "--resume",
                      refusal("{\"format\":\"other 1\"}\n{\"row\":1}\n", "b.jsonl"));
  EXPECT_THROW(read({directory_ / "none.json"}), ResultError);
  EXPECT_THROW(read({directory_ / "."}), ResultError);
}

TEST_F(ReadingTest, TheToolSaysSoInOneLineAndExitsWithTwo) {
  const auto file = write("a.json", "[{\"kind\": \"contention\"");
  const std::string command = std::string(IRT_REPORT) + " '" + file.string() + "' --out '" +
                              (directory_ / "page.html").string() + "' 2> '" +
                              (directory_ / "err").string() + "'";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
  std::ifstream err(directory_ / "err");
  const std::string said{std::istreambuf_iterator<char>(err), {}};
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "a.json", said);
  EXPECT_FALSE(std::filesystem::exists(directory_ / "page.html"));
}

TEST_F(ReadingTest, ADirectoryIsReadAsFarAsItHoldsResults) {
  write("a.json", synthetic::sweep({"lock"}, {1, 2}).dump());
  write("doctor.json", "{\"findings\": []}");
  write("torn.json", "[{");
  write("notes.txt", "no JSON at all");
  const Results results = read({directory_ / "."});
  EXPECT_EQ(results.runs.size(), 2u);
  EXPECT_EQ(results.files.size(), 1u);
  ASSERT_EQ(results.notes.size(), 2u);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "doctor.json", results.notes[0]);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "torn.json", results.notes[1]);
}

TEST_F(ReadingTest, AnInterruptedSweepIsReadUpToItsTornLine) {
  std::string lines;
  for (const Json& run : synthetic::sweep({"lock"}, {1, 2, 4})) lines += run.dump() + '\n';
  lines.resize(lines.size() - 20);
  const Results results = read({write("runs.jsonl", lines)});
  EXPECT_EQ(results.runs.size(), 2u);
  ASSERT_EQ(results.notes.size(), 1u);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "torn", results.notes[0]);
}

TEST_F(ReadingTest, AnInterruptedContentionSweepIsSummedUp) {
  contention::Row lock;
  lock.queue = "lock";
  lock.scenario = "pairs";
  lock.claims = nlohmann::json{{"ordering", "FIFO"}};
  lock.placement.text = "close";
  contention::Row broken = lock;
  broken.queue = "mine";
  const nlohmann::json header{{"format", contention::journal_format},
                              {"plan", contention::Plan()},
                              {"rows", {lock, broken}},
                              {"calibration", contention::Calibration()},
                              {"conditions", synthetic::conditions()}};
  std::string lines = header.dump() + '\n';
  for (unsigned repetition = 0; repetition < 3; ++repetition) {
    contention::Result result{.row = 0, .repetition = repetition, .pass = {}, .sample = {}};
    result.sample.seconds = 0.5;
    result.sample.pushes = result.sample.pops = 100 + repetition;
    lines += nlohmann::json(result).dump() + '\n';
  }
  contention::Result crash{.row = 1, .repetition = 0, .pass = {}, .sample = {}};
  crash.sample.status = "crashed";
  lines += nlohmann::json(crash).dump() + '\n' + "{\"row\": 1, \"rep";
  const Results results = read({write("contention.jsonl", lines)});
  ASSERT_EQ(results.runs.size(), 2u);
  EXPECT_EQ(results.runs[0].number("operations_per_second"), 404);
  EXPECT_EQ(results.runs[0].number("repetitions"), 3);
  EXPECT_EQ(results.runs[0].status(), "ok");
  EXPECT_EQ(results.runs[1].status(), "crashed");
  ASSERT_EQ(results.notes.size(), 2u);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "4 results; the last line is torn", results.notes[0]);

  crash.row = 7;
  const std::string nowhere = header.dump() + '\n' + nlohmann::json(crash).dump() + '\n';
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "unknown", refusal(nowhere, "a.jsonl"));
}

TEST_F(ReadingTest, ShardsMergeAndWhatIsThereTwiceCountsOnce) {
  const Json all = synthetic::sweep({"lock", "lfree"}, {1, 2, 4});
  Json first = Json::array(), second = Json::array();
  for (std::size_t i = 0; i < all.size(); ++i) (i < 4 ? first : second).push_back(all[i]);
  second.push_back(all[0]);
  Json again = all[1];  // the same question, asked again later
  again["operations_per_second"] = 1234;
  again["conditions"]["time"] = "2026-02-01T00:00:00Z";
  second.push_back(again);
  const Results results = read({write("1.json", first.dump()), write("2.json", second.dump())});
  EXPECT_EQ(results.runs.size(), 6u);
  EXPECT_EQ(results.environments.size(), 1u);
  ASSERT_EQ(results.notes.size(), 2u);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "more than once", results.notes[0]);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "newest", results.notes[1]);
  EXPECT_TRUE(std::ranges::any_of(results.runs, [](const report::Run& run) {
    return run.number("operations_per_second") == 1234;
  }));
}

// Whatever tells runs apart, two runs that differ in nothing else are both kept.
TEST_F(ReadingTest, RunsThatDifferInOneChoiceAreTwoAnswers) {
  for (const results::Field& field : results::fields) {
    if (!field.tells_apart || field.key == "kind") continue;
    Json one = (field.by & results::by_operations) != 0 ? synthetic::operations("lock", 2, 1e6)
                                                        : synthetic::frames("lock", 2, 256, 9);
    if (field.by == results::by_micro) one = {{"kind", "micro"}, {"ns_per_operation", 3}};
    Json other = one;
    one[std::string(field.key)] = "one";
    other[std::string(field.key)] = "other";
    const Results results = read({write("a.json", Json::array({one, other}).dump())});
    EXPECT_EQ(results.runs.size(), 2u) << field.key;
  }
}

// ... and what came out does not make two questions of one.
TEST_F(ReadingTest, RunsThatDifferInAFigureAnswerOneQuestion) {
  for (const results::Field& field : results::fields) {
    if (field.role != results::Role::figure) continue;
    Json one = synthetic::operations("lock", 2, 1e6);
    Json other = one;
    other[std::string(field.key)] = "other";
    const Results results = read({write("a.json", Json::array({one, other}).dump())});
    EXPECT_EQ(results.runs.size(), 1u) << field.key;
  }
}

TEST_F(ReadingTest, ValuesThatDifferByRoundingAreOne) {
  Json one = synthetic::frames("lock", 2, 256, 9), other = one;
  one["mean_task_us"] = 20.0;
  other["mean_task_us"] = 20.000000000000004;
  EXPECT_EQ(read({write("a.json", Json::array({one, other}).dump())}).runs.size(), 1u);
}

TEST_F(ReadingTest, TheSpeedUpOfAShardIsTakenFromTheOthers) {
  Json first =
      Json::array({synthetic::frames("lock", 1, 256, 9), synthetic::frames("lfree", 1, 256, 10)});
  Json second = Json::array({synthetic::frames("lock", 4, 256, 30)});
  second[0]["speed_up"] = nullptr;
  const Results results = read({write("1.json", first.dump()), write("2.json", second.dump())});
  EXPECT_EQ(results.runs[2].number("speed_up"), 3);
}

TEST_F(ReadingTest, ClaimsThatAToolDoesNotWriteAreTheQueuesOwn) {
  const Results results = read({write("a.json", Json::array({synthetic::frames("lfree", 1, 256, 9),
                                                             synthetic::frames("mine", 1, 256, 9)})
                                                    .dump())});
  EXPECT_EQ(results.runs[0].fields.at("claims").at("push"), "lock-free");
  EXPECT_EQ(results.runs[0].fields.at("claims").at("reclamation"), "hazard pointers");
  EXPECT_FALSE(results.runs[1].fields.contains("claims"));
}

TEST_F(ReadingTest, OtherConditionsAreAnotherEnvironmentAndSaidSo) {
  Json here = synthetic::sweep({"lock"}, {1, 2}), there = here;
  for (Json& run : there) run["conditions"]["governor"] = "powersave";
  const Results results = read({write("a.json", here.dump()), write("b.json", there.dump())});
  EXPECT_EQ(results.runs.size(), 4u);
  EXPECT_EQ(results.environments.size(), 2u);
  ASSERT_EQ(results.notes.size(), 1u);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "differ in governor", results.notes[0]);
}

TEST_F(ReadingTest, GoogleBenchmarksRepetitionsBecomeAMeanWithItsInterval) {
  const Results results =
      read({write("micro.json", synthetic::micro({"push_pop<lock>", "pop_empty"}).dump())});
  ASSERT_EQ(results.runs.size(), 2u);
  const report::Run& run = results.runs[0];
  EXPECT_EQ(run.subject(), "push_pop<lock>");
  EXPECT_NEAR(*run.number("ns_per_operation"), 8.2, 1e-9);
  // Three samples, 0.2 apart: t(0.975; 2) = 4.3027, times 0.2 / sqrt(3).
  EXPECT_NEAR(*run.number("ns_per_operation_high") - 8.2, 0.49683, 1e-4);
  std::set<std::string> keys = keys_of(run.fields);
  keys.insert("conditions");  // in the environment
  EXPECT_EQ(keys, fields_by(results::by_micro));
  const Json& conditions = results.environments[0];
  EXPECT_EQ(conditions.at("hardware_threads"), 64);
  EXPECT_FALSE(conditions.contains("host_name"));
  EXPECT_FALSE(conditions.contains("executable"));
}

TEST_F(ReadingTest, WhatDidNotEndWellIsNamed) {
  Json runs = synthetic::sweep({"lock", "lfree"}, {1, 2});
  runs[3]["status"] = "hung";
  Json broken = synthetic::frames("local", 2, 256, 10);
  broken["lost_tasks"] = 3;
  runs.push_back(broken);
  const Results results = read({write("a.json", runs.dump())});
  EXPECT_EQ(results.runs[4].status(), "broken");
  const auto noted = [&](const char* part) {
    return std::ranges::any_of(results.notes, [&](const std::string& note) {
      return note.find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(noted("hung: lfree"));
  EXPECT_TRUE(noted("broken: local"));
}

}  // namespace
}  // namespace irt::report
