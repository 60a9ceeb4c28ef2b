// Code built without the plug-in of GCC: what a call returns is stored where no hook says so. Where
// the checker does not see all that is written it accuses nobody of reading what was not.

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "stress/checker/queue_check.hpp"
#include "stress/checker/queue_client.hpp"
#include "stress/checker/verdict.hpp"

namespace irt::checker {
namespace {

QueueResult check(const char* probe, std::size_t queue, bool reports = true) {
  virtual_cores::Module module(probe);
  const QueueEntry& entry = module.function<const QueueEntry*()>("irt_probe_entries")()[queue];
  CheckSettings settings{.seconds = 5, .generated = 0};
  settings.quiet = true;
  settings.reports = reports;
  return check_queue(entry, module, settings, "irt check");
}
constexpr std::size_t bug = 0;
constexpr std::size_t fixed = 1;

bool finds(const QueueResult& result, FindingKind kind) {
  return std::ranges::any_of(result.shapes, [kind](const ShapeResult& s) {
    return s.result.finding && s.result.finding->kind == kind;
  });
}

#if defined(__GNUC__) && !defined(__clang__)
TEST(Unannounced, stores_look_like_none_to_one_search) {
  virtual_cores::Module module(IRT_CALL_RESULT_PROBE);
  const QueueEntry& entry = module.function<const QueueEntry*()>("irt_probe_entries")()[fixed];
  QueueClient client(entry, parse_shape("E|D"), 0, &module);
  const Result result = checker::check(client.program(), {});
  ASSERT_TRUE(result.finding);
  EXPECT_EQ(result.finding->kind, FindingKind::uninitialised_read) << "nothing to take back";
}
#endif

TEST(Unannounced, stores_make_nobody_a_reader_of_uninitialised_memory) {
  for (const bool reports : {true, false})
    EXPECT_FALSE(check(IRT_CALL_RESULT_PROBE, fixed, reports).found) << reports;
  const QueueResult result = check(IRT_CALL_RESULT_PROBE, fixed);
  const std::string text = verdict("q", result);
#if defined(__GNUC__) && !defined(__clang__)
  EXPECT_EQ(text.find("Proved: "), std::string::npos) << text;
  EXPECT_NE(text.find("that no hook announces"), std::string::npos) << text;
  ASSERT_FALSE(result.unseen.instructions.empty());
  EXPECT_NE(result.unseen.instructions[0].find("call_result.hpp:"), std::string::npos);
#endif
}

TEST(Unannounced, stores_hide_only_themselves) {
  EXPECT_TRUE(finds(check(IRT_NEVER_WRITTEN_PROBE, bug), FindingKind::uninitialised_read));
  EXPECT_TRUE(finds(check(IRT_NEVER_WRITTEN_PROBE, bug, false), FindingKind::uninitialised_read));
  const QueueResult result = check(IRT_NEVER_WRITTEN_PROBE, fixed);
  EXPECT_FALSE(result.found);
  EXPECT_NE(verdict("q", result).find("Proved: "), std::string::npos) << verdict("q", result);
}

}  // namespace
}  // namespace irt::checker
