// Each fault is found by every search, and nothing is found where nothing is wrong.

#include "tests/stress/checker/findings.hpp"

#include <gtest/gtest.h>
#include <string>

#include "stress/checker/checker.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"

namespace checker = irt::checker;

namespace {

class Findings : public testing::Test {
 protected:
  std::vector<irt::findings::Program> programs() {
    unsigned count = 0;
    const auto* first =
        module_.function<const irt::findings::Program*(unsigned*)>("irt_findings_programs")(&count);
    return {first, first + count};
  }

  checker::Program program_of(const irt::findings::Program& program) {
    checker::Program checked;
    checked.module = &module_;
    for (const auto thread : program.threads)
      if (thread != nullptr) checked.threads.emplace_back(thread);
    if (program.prepare != nullptr) checked.prepare = program.prepare;
    if (program.finish != nullptr) checked.finish = program.finish;
    return checked;
  }

  /// Whether it reaches a limit of the checker, so that nothing can be said of it.
  static bool is_limit(const irt::findings::Program& program) {
    return std::string_view(program.finding) == "not proved";
  }

  static std::string found(const checker::Result& result) {
    return result.finding ? std::string(name_of(result.finding->kind)) : "";
  }

  irt::virtual_cores::Module module_{IRT_FINDINGS_PROBE};
};

}  // namespace

TEST_F(Findings, exhaustive_search_finds_what_is_wrong_and_nothing_else) {
  for (const auto& program : programs()) {
    const checker::Program checked = program_of(program);
    const checker::Result result = check(checked, {.seconds = 10});
    if (is_limit(program)) {
      EXPECT_EQ(found(result), "") << program.name << ": " << result.finding->text;
      EXPECT_FALSE(result.finished) << program.name;
      EXPECT_NE(result.incomplete, "") << program.name;
      continue;
    }
    EXPECT_EQ(found(result), program.finding)
        << program.name << ": " << (result.finding ? result.finding->text : "");
    EXPECT_TRUE(result.finished || result.finding) << program.name << " was not finished";
  }
}

TEST_F(Findings, bounded_and_random_searches_agree) {
  for (const auto& program : programs()) {
    if (is_limit(program)) continue;
    const checker::Program checked = program_of(program);
    for (const auto search : {checker::Search::bounded, checker::Search::random,
                              checker::Search::pct, checker::Search::pos}) {
      // A loop has its way only if nobody else runs before it gives up, which is seldom drawn.
      if (std::string_view(program.name).starts_with("gives up")) continue;
      // libstdc++ polls 16 times before it sleeps; a fair coin seldom lets it.
      if (search == checker::Search::random && std::string(program.name).starts_with("atomic wait"))
        continue;
      const bool broken = !std::string_view(program.finding).empty();
      const checker::Result result =
          check(checked, {.search = search, .budget = 2, .executions = broken ? 1000U : 200U});
      EXPECT_EQ(found(result), program.finding)
          << program.name << " by search " << static_cast<int>(search) << ": "
          << (result.finding ? result.finding->text : "");
    }
  }
}

TEST_F(Findings, a_schedule_finds_the_same_again) {
  for (const auto& program : programs()) {
    if (is_limit(program) || std::string_view(program.finding).empty()) continue;
    const checker::Program checked = program_of(program);
    for (const auto search : {checker::Search::exhaustive, checker::Search::random}) {
      const checker::Options options{.search = search, .executions = 1000};
      const checker::Result result = check(checked, options);
      if (!result.finding) continue;
      const std::string text = to_string(result.schedule);
      const auto execution = repeat(checked, options, checker::parse_schedule(text));
      ASSERT_NE(execution, nullptr) << program.name << " " << text;
      EXPECT_EQ(execution->finding()->text, result.finding->text) << program.name;
    }
  }
}

TEST(Schedule, is_refused_with_a_reason) {
  for (const char* text : {"", "a3", "s:A", "s:a0", "s:3a"})
    EXPECT_THROW(checker::parse_schedule(text), std::invalid_argument) << text;
  EXPECT_EQ(to_string(checker::parse_schedule("s:a3b'1a2")), "s:a3b'1a2");
}

TEST_F(Findings, memory_that_comes_back_is_a_choice) {
  for (const auto& program : programs()) {
    if (std::string(program.name) != "memory comes back") continue;
    checker::Options options;
    options.limits.reuse_memory = true;
    const checker::Result result = check(program_of(program), options);
    EXPECT_EQ(found(result), "failure");
    EXPECT_GE(result.complete, 1U) << "it need not come back";
  }
}

TEST_F(Findings, as_many_allocations_fail_as_may) {
  for (const auto& program : programs()) {
    if (std::string(program.name) != "memory runs out") continue;
    checker::Options options;
    for (const unsigned most : {1U, 2U}) {
      options.limits.failing_allocations = most;
      const checker::Result result = check(program_of(program), options);
      EXPECT_EQ(found(result), most == 1 ? "" : "failure");
      EXPECT_EQ(result.complete, 3U) << "none, the first or the second alone";
    }
  }
}

TEST_F(Findings, what_no_hook_announces_is_named) {
  const std::vector<std::string> unseen =
      irt::symbols::Symbols(module_).unseen_instructions().places;
  ASSERT_EQ(unseen.size(), 1U);
  EXPECT_TRUE(unseen[0].starts_with("lock addl at findings_probe.cpp:")) << unseen[0];
}
