// A counter of 32 bits that wraps: ageing by nearly 2^32 pairs takes minutes.

#include <gtest/gtest.h>

#include "stress/checker/queue_client.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {
namespace {

TEST(OldQueue, finds_a_counter_of_32_bits_that_wraps) {
  virtual_cores::Module module(IRT_CASES_PROBE);
  QueueClient client(probe_entry(module, "narrow-index-32-bug"),
                     parse_shape("F:DD|EE@3+4294967294"), 0, &module);
  const Result result = check(client.program(), {});
  ASSERT_TRUE(result.finding) << result.incomplete;
  EXPECT_EQ(result.finding->kind, FindingKind::wrong_outcome);
}

}  // namespace
}  // namespace irt::checker
