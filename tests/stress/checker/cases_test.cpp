// Each queue of tests/stress/cases gets its right verdict from what `irt check` does by default:
// broken ones the right kind of finding, healthy ones none. A case stands for its kind; its sisters
// are rows beside it.

#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/queue_check.hpp"

namespace irt::checker {
namespace {

struct Case {
  std::string_view queue;
  std::vector<FindingKind> right;  ///< any of these; none: healthy
};

// clang-format off
const std::vector<Case> cases{
    {"waits-for-recycled-bug", {FindingKind::livelock}},
    {"waits-for-recycled-counted-bug", {FindingKind::livelock}},
    {"waits-for-recycled-stored-bug", {FindingKind::livelock}},
    {"waits-for-recycled-fixed", {}},
    {"one-short-bug", {FindingKind::wrong_outcome}},
    {"one-short-producers-bug", {FindingKind::wrong_outcome}},
    {"one-short-unordered-bug", {FindingKind::wrong_outcome}},
    {"one-short-fixed", {}},
    {"unpublished-bug", {FindingKind::data_race}},
    {"unpublished-fixed", {}},
    {"dropped-list-uses-bug", {FindingKind::use_after_free}},
    {"dropped-list-leaks-bug", {FindingKind::leak}},
    {"dropped-list-twice-bug", {FindingKind::double_free}},
    {"dropped-list-fixed", {}},
    {"dropped-ring-looks-bug", {FindingKind::livelock}},
    {"dropped-ring-wipes-bug", {FindingKind::livelock}},
    {"dropped-ring-fixed", {}},
    {"long-spin", {}},
    {"notified-twice-bug", {FindingKind::deadlock}},
    {"notified-twice-fixed", {}},
    {"shared-line-bug", {}},  // it is slow, and right
    {"shared-line-fixed", {}},
    {"chase", {}},
    {"many-sc", {}},
    {"load-time", {}},
    {"load-time-grown", {}},
    {"registry", {}},
    {"narrow-index-bug", {FindingKind::wrong_outcome}},
    {"narrow-index-16-bug", {FindingKind::wrong_outcome}},
    {"narrow-index-fixed", {}},
    {"failed-growth-bug", {FindingKind::livelock}},
    {"failed-growth-fixed", {}},
    {"tagged-top", {}},
    {"tagged-low", {}},
    {"tagged-inside", {}},
    {"tagged-bug", {FindingKind::leak}},
    {"call-result-bug", {FindingKind::data_race}},
    {"call-result-fixed", {}},
    {"sanitizer-macro-bug", {FindingKind::data_race}},
    {"list-queue", {}},
    {"endless-wait-bug", {FindingKind::livelock}},
    {"endless-pause-bug", {FindingKind::livelock}},
    {"endless-yield-bug", {FindingKind::livelock}},
    {"endless-call-bug", {FindingKind::livelock}},
    {"endless-rounds-bug", {FindingKind::livelock}},
    {"endless-fixed", {}},
    {"computes-a-while", {}},
    {"traps-bug", {FindingKind::failure}},
    {"divides-bug", {FindingKind::failure}},
    {"breaks-bug", {FindingKind::failure}},
    {"traps-fixed", {}},
};
// clang-format on

class Cases : public testing::Test {
 protected:
  const QueueEntry& entry(std::string_view name) {
    unsigned count = 0;
    const auto* entries =
        module_.function<const QueueEntry*(unsigned*)>("irt_probe_entries")(&count);
    for (unsigned i = 0; i < count; ++i)
      if (entries[i].name == name) return entries[i];
    throw std::invalid_argument("no such case");
  }

  QueueResult check(std::string_view queue, double seconds, bool reports = false) {
    CheckSettings settings;
    settings.quiet = true;
    settings.reports = reports;
    settings.seconds = seconds;
    return check_queue(entry(queue), module_, settings, "");
  }

  /// "livelock on EE:DE|D", or "nothing".
  static std::string finding_of(const QueueResult& result, FindingKind* kind = nullptr) {
    for (const ShapeResult& shape : result.shapes) {
      if (!shape.result.finding) continue;
      if (kind != nullptr) *kind = shape.result.finding->kind;
      return std::string(name_of(shape.result.finding->kind)) + " on " + shape.shape + ": " +
             shape.result.finding->text;
    }
    return "nothing";
  }

  virtual_cores::Module module_{IRT_CASES_PROBE};
};

TEST_F(Cases, broken_ones_are_found_as_what_they_are) {
  for (const Case& c : cases) {
    if (c.right.empty()) continue;
    FindingKind kind{};
    const QueueResult result = check(c.queue, 60);
    const std::string found = finding_of(result, &kind);
    EXPECT_TRUE(result.found && std::find(c.right.begin(), c.right.end(), kind) != c.right.end())
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

// A check by default has 50 s for each; what accuses falsely mostly does so at once.
TEST_F(Cases, healthy_ones_are_not_accused) {
  for (const Case& c : cases) {
    if (!c.right.empty()) continue;
    const QueueResult result = check(c.queue, 1);
    EXPECT_FALSE(result.found) << c.queue << ": " << finding_of(result);
  }
}

}  // namespace
}  // namespace irt::checker
