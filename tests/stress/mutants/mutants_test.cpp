// The table, every healthy twin, and those mutants that fall at once. The whole matrix takes
// minutes:
// `./irt stress --mutants`.
#include "stress/mutants/mutants.hpp"

#include <gtest/gtest.h>
#include <set>
#include <string>

#include "stress/threads/child.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {
namespace {

Result run(const QueueEntry& queue, const Scenario& scenario, double seconds) {
  static const ClockQuality clock = calibrate();
  const Assignment assignment{queue, clock, seconds, 1, "repeat"};
  Result result;
  run_in_child(
      result, seconds, 30, [&](Messenger& m) { run_scenario(assignment, scenario, m); },
      [](std::uint64_t) {});
  return result;
}

TEST(Mutants, ThirtyTwoAndTheTwoListings) {
  std::set<std::string_view> ids;
  for (const Mutant& mutant : mutants()) {
    EXPECT_TRUE(ids.insert(mutant.id).second) << mutant.id;
    EXPECT_EQ(mutant.seen == by_none, !mutant.needs.empty())
        << mutant.id << ": who is seen by nobody says what it takes";
  }
  EXPECT_EQ(ids.size(), 34U);
}

TEST(Mutants, NoTwinIsAccused) {
  for (const Mutant& mutant : mutants()) {
    const Result result = run(mutant.twin, mutant.scenario, 0.1);
    EXPECT_TRUE(result.findings.empty()) << mutant.id << ": " << result.findings[0].claim << "\n"
                                         << result.findings[0].evidence;
  }
}

class FallsAtOnce : public testing::TestWithParam<std::string> {};

TEST_P(FallsAtOnce, WithinTheTime) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the plain build's instrument";
  for (const Mutant& mutant : mutants()) {
    if (mutant.id != GetParam()) continue;
    EXPECT_FALSE(run(mutant.queue, mutant.scenario, 10).findings.empty());
    return;
  }
  FAIL() << "no such mutant";
}

INSTANTIATE_TEST_SUITE_P(Mutants, FallsAtOnce,
                         testing::Values("m13", "m20", "m28", "m30", "m31", "m32", "m40", "m41",
                                         "m42", "m44", "m46", "thesis-7.1"),
                         [](const auto& test) {
                           std::string name = test.param;
                           for (char& c : name) {
                             if (c == '-' || c == '.') c = '_';
                           }
                           return name;
                         });

}  // namespace
}  // namespace irt::stress
