// What a reader needs to see is in the report, at its place.

#include "stress/checker/report.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <regex>
#include <string>

#include "stress/checker/fold.hpp"
#include "tests/stress/checker/findings.hpp"

namespace checker = irt::checker;

namespace {

/// The report of a program with its lines' numbers as `#`, so that they may move.
class Report : public testing::Test {
 protected:
  std::string of(const std::string& name) {
    unsigned count = 0;
    const auto* programs =
        module_.function<const irt::findings::Program*(unsigned*)>("irt_report_programs")(&count);
    for (unsigned i = 0; i < count; ++i)
      if (programs[i].name == name) return of(programs[i]);
    ADD_FAILURE() << "no program " << name;
    return "";
  }

  static void expect_in_order(const std::string& text, const std::vector<std::string>& parts) {
    std::size_t at = 0;
    for (const std::string& part : parts) {
      const std::size_t found = text.find(part, at);
      EXPECT_NE(found, std::string::npos) << "missing: " << part << "\nin:\n" << text;
      if (found != std::string::npos) at = found + part.size();
    }
  }

 private:
  std::string of(const irt::findings::Program& program) {
    checker::Program checked;
    checked.module = &module_;
    for (const auto thread : program.threads)
      if (thread != nullptr) checked.threads.emplace_back(thread);
    if (program.prepare != nullptr) checked.prepare = program.prepare;
    if (program.finish != nullptr) checked.finish = program.finish;
    const checker::Result result = check(checked, {.seconds = 20});
    if (!result.finding || name_of(result.finding->kind) != program.finding) {
      ADD_FAILURE() << program.name << " is not found as " << program.finding;
      return "";
    }
    const std::string text = sentence_and_steps(checked, result.schedule);
    const checker::Schedule again = checker::parse_schedule(to_string(result.schedule));
    EXPECT_EQ(sentence_and_steps(checked, again), text) << "a replay shows the same";
    return std::regex_replace(text, std::regex("(report_probe.cpp:|line |  )[0-9]+\\b"), "$1#");
  }

  std::string sentence_and_steps(const checker::Program& checked,
                                 const checker::Schedule& schedule) {
    const auto execution = repeat(checked, {}, schedule);
    if (execution == nullptr) return "it does not come out again";
    irt::symbols::Symbols symbols(module_);
    return sentence(*execution->finding(), symbols) + "\n" + columns(*execution, {}, symbols) +
           standings(*execution, symbols);
  }

  irt::virtual_cores::Module module_{IRT_REPORT_PROBE};
};

std::vector<checker::Row> rows(const std::vector<std::string>& texts) {
  std::vector<checker::Row> result;
  result.reserve(texts.size());
  for (const std::string& text : texts) result.push_back({0, text, text.substr(0, 1)});
  return result;
}

std::string folded(const std::vector<std::string>& texts) {
  std::string text;
  for (const checker::Row& row : checker::fold(rows(texts))) text += row.text + "\n";
  return text;
}

}  // namespace

TEST_F(Report, says_the_order_of_each_step) {
  expect_in_order(
      of("orders"),
      {"Numbers are lines of report_probe.cpp", "# x.compare_exchange_strong acq_rel = 0 <- 1",
       "# y.store release <- 2", "# fence seq_cst", "# y.load acquire = 2",
       "# x.compare_exchange_strong fails, relaxed = 1"});
}

TEST_F(Report, folds_rounds_of_several_lines) {
  expect_in_order(of("rounds"),
                  {"# x.load acquire = 1", "# y.load relaxed = 0", "... these 2 lines 15 times"});
}

TEST_F(Report, shows_the_first_and_the_last_round_where_values_differ) {
  expect_in_order(of("rounds with other values"),
                  {"x.fetch_add relaxed = 0 <- 1", "... 13 more like this, with other values, then",
                   "x.fetch_add relaxed = 14 <- 15"});
}

TEST_F(Report, marks_a_store_that_comes_earlier_in_modification_order) {
  expect_in_order(of("modification order"),
                  {"store relaxed <- ", "^ placed before the store at report_probe.cpp:# by",
                   "in modification order"});
}

TEST_F(Report, shows_both_accesses_of_a_race_where_they_were_made) {
  const std::string race = of("race");
  expect_in_order(race, {"data = 1;  plain write", "^ races with line # of thread 1",
                         "x.store relaxed <- 1", "x.load acquire = 1",
                         "y.store(data, rlx);  plain read", "^ races with line # of thread 0"});
  expect_in_order(of("race with an atomic access"),
                  {"x.store relaxed <- 1", "^ races with line # of thread 1", "plain write",
                   "^ races with line # of thread 0"});
}

TEST_F(Report, shows_who_allocated_and_freed_what_is_freed_twice_or_used_after) {
  expect_in_order(of("double free"),
                  {"std::free(block);  freed", "^ the first time", "x.store release <- 1",
                   "x.load acquire = 1", "std::free(block);  freed", "^ the second time"});
  expect_in_order(of("use after free"),
                  {"int* const mine = new int(5);  allocated", "shared.store release <- &1",
                   "delete mine;  freed", "^ used later at line #", "shared.load acquire = &1",
                   "plain read", "^ of memory that was freed at", "Blocks of the heap:",
                   // NOLINTNEXTLINE(bugprone-suspicious-missing-comma)
                   "&1   # bytes, allocated at report_probe.cpp:# by thread 0, freed at "
                   "report_probe.cpp:# by thread 0"});
}

TEST_F(Report, says_where_each_thread_stands) {
  expect_in_order(of("deadlock"), {"thread 0 waits at report_probe.cpp:#, and last saw",
                                   "stored at report_probe.cpp:# by thread 1",
                                   "thread 1 waits at report_probe.cpp:#, and last saw",
                                   "stored at report_probe.cpp:# by thread 0"});
  expect_in_order(of("livelock"),
                  {"thread 0 has ended", "thread 1 loops at report_probe.cpp:#, and last saw",
                   "x.load acquire = 3, stored at report_probe.cpp:# by thread 0"});
}

TEST(Contradiction, names_the_element_that_an_empty_missed) {
  using checker::QueueCall;
  using Kind = QueueCall::Kind;
  using Phase = QueueCall::Phase;
  const auto call = [](Kind kind, std::size_t number, Phase phase, bool answered,
                       std::uint64_t value) {
    return QueueCall{.kind = kind,
                     .number = number,
                     .phase = phase,
                     .answered = answered,
                     .finished = true,
                     .value = value};
  };
  const QueueCall push = call(Kind::push, 0, Phase::before, true, 101);
  const QueueCall empty = call(Kind::pop, 1, Phase::during, false, 0);
  EXPECT_EQ(contradiction(empty, {push, empty, call(Kind::pop, 2, Phase::after, true, 101)}),
            "push 101 happens before it, and nobody had taken that");
  EXPECT_EQ(contradiction(empty, {push, call(Kind::pop, 0, Phase::during, true, 101), empty}), "");
  EXPECT_EQ(contradiction(empty, {call(Kind::push, 2, Phase::during, true, 101), empty}), "");
}

TEST(History, shows_of_many_calls_alike_the_first_and_the_last) {
  using checker::QueueCall;
  std::vector<QueueCall> operations;
  for (std::size_t i = 0; i < 70; ++i)
    operations.push_back({.kind = QueueCall::Kind::push,
                          .number = i,
                          .phase = QueueCall::Phase::before,
                          .answered = i != 40,
                          .finished = true,
                          .value = 301 + i});
  operations.push_back({.kind = QueueCall::Kind::pop, .finished = true});
  const std::string text = checker::history(operations, "(of 341) answered \"full\"");
  for (const char* part : {"push 301", "push 303", "and 34 more", "push 341 -> full", "push 370"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(text.find("push 310"), std::string::npos) << text;
  EXPECT_LT(std::ranges::count(text, '\n'), 20) << text;
}

TEST(Fold, leaves_what_does_not_repeat) {
  EXPECT_EQ(folded({"a", "b", "a", "b"}), "a\nb\na\nb\n");
  EXPECT_EQ(folded({"a1", "a2", "a3", "a4", "b"}), "a1\na2\na3\na4\nb\n");
  EXPECT_EQ(folded({}), "");
}

TEST(Fold, says_how_often) {
  EXPECT_EQ(folded({"x", "a", "a", "a", "y"}), "x\na\n    ... 3 times\ny\n");
  EXPECT_EQ(folded({"a", "b", "a", "b", "a", "b", "a"}),
            "a\nb\n    ... these 2 lines 3 times\na\n");
}
