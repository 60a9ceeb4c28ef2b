// A counter of 32 bits that wraps: ageing by nearly 2^32 pairs takes minutes.

#include <gtest/gtest.h>

#include "stress/checker/queue_client.hpp"

namespace irt::checker {
namespace {

TEST(OldQueue, finds_a_counter_of_32_bits_that_wraps) {
  virtual_cores::Module module(IRT_CASES_PROBE);
  unsigned count = 0;
  const auto* entries = module.function<const QueueEntry*(unsigned*)>("irt_probe_entries")(&count);
  const QueueEntry* entry = nullptr;
  for (unsigned i = 0; i < count; ++i)
    if (entries[i].name == "narrow-index-32-bug") entry = &entries[i];
  ASSERT_NE(entry, nullptr);
  QueueClient client(*entry, parse_shape("F:DD|EE@3+4294967294"), 0, &module);
  const Result result = check(client.scenario(), {});
  ASSERT_TRUE(result.finding) << result.incomplete;
  EXPECT_EQ(result.finding->kind, FindingKind::wrong_outcome);
}

}  // namespace
}  // namespace irt::checker
