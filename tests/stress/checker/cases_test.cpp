// Each queue of tests/stress/cases gets its right verdict from what `irt check` does by default:
// broken ones the right kind of finding, healthy ones none.

#include "tests/stress/checker/cases.hpp"

#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

namespace irt::checker {
namespace {

TEST_F(Cases, broken_ones_are_found_as_what_they_are) {
  for (const Case& c : cases) {
    if (c.right.empty()) continue;
    FindingKind kind{};
    const QueueResult result = check(c.queue, 60);
    const std::string found = finding_of(result, &kind);
    EXPECT_TRUE(result.found && std::ranges::find(c.right, kind) != c.right.end())
        << c.queue << ": " << found;
  }
}

TEST_F(Cases, faults_of_the_processor_have_a_line_and_columns) {
  const std::pair<const char*, const char*> faults[] = {
      {"traps-bug", "failure: an illegal instruction, as __builtin_trap() is one, at traps.hpp:"},
      {"divides-bug",
       "failure: a division by zero, or with a result that does not fit, at traps.hpp:"},
      {"breaks-bug", "failure: a breakpoint at traps.hpp:"},
      {"endless-wait-bug", " for ever: it looks at no memory but its stack"},
      {"endless-yield-bug", " loops at endless.hpp:"},
  };
  for (const auto& [queue, words] : faults) {
    const QueueResult result = check(queue, 60, true);
    ASSERT_TRUE(result.found) << queue;
    const std::string& report = result.shapes.back().report;
    for (const char* part : {words, "\nthread 0 ", "replay: "})
      EXPECT_NE(report.find(part), std::string::npos) << queue << ": " << report;
  }
}

TEST_F(Cases, what_was_wrong_is_in_the_columns_which_a_terminal_can_show) {
  const std::pair<const char*, std::vector<const char*>> broken[] = {
      {"one-short-bug", {"-> full", "^ nothing can have been inside"}},
      {"unpublished-bug",
       {"writes what 101 points to", "^ races with the read of it by thread", "push 101",
        "reads what 101 points to", "^ races with the write of it by thread"}},
  };
  for (const auto& [queue, parts] : broken) {
    const QueueResult result = check(queue, 60, true);
    ASSERT_TRUE(result.found) << queue;
    const std::string& report = result.shapes.back().report;
    std::size_t at = report.find("\nthread 0");
    ASSERT_NE(at, std::string::npos) << report;
    std::istringstream columns(report.substr(at + 1, report.find("\nreplay: ") - at));
    for (std::string line; std::getline(columns, line);) EXPECT_LE(line.size(), 120U) << line;
    for (const char* part : parts) {
      at = report.find(part, at);
      ASSERT_NE(at, std::string::npos) << "missing: " << part << "\n" << report;
    }
  }
}

// cases_full_test.cpp gives them the default time.
TEST_F(Cases, healthy_ones_are_not_accused) {
  for (const Case& c : cases) {
    if (!c.right.empty()) continue;
    const QueueResult result = check(c.queue, 0.15);
    EXPECT_FALSE(result.found) << c.queue << ": " << finding_of(result);
  }
}

}  // namespace
}  // namespace irt::checker
