// The search that exchanges equal threads: what it leaves out, and when it does not.

#include "stress/checker/parts.hpp"
#include "stress/checker/queue_client.hpp"
#include "tests/stress/checker/probe_entries.hpp"
#include "tests/stress/checker/twin_programs.hpp"

namespace {

namespace checker = irt::checker;
using irt::twins::Tally;

class Twins : public irt::twins::TwinPrograms {
 protected:
  const irt::QueueEntry& entry(std::string_view name) {
    return checker::probe_entry(module_, name);
  }

  checker::Result check(std::string_view queue, std::string_view shape, bool symmetry,
                        unsigned jobs = 1) {
    checker::QueueClient client(entry(queue), checker::parse_shape(shape), 2, &module_);
    return checker::check_in_parts(client.program(), {.symmetry = symmetry}, jobs);
  }
};

}  // namespace

TEST_F(Twins, one_graph_of_each_orbit_is_explored) {
  const Tally tally = compare_random(300, 0, 20260728);
  EXPECT_GT(tally.compared, 200U);
  EXPECT_LT(tally.some * 3, tally.all);
}

TEST_F(Twins, threads_that_differ_somewhere_are_not_taken_for_equal) {
  const Tally tally = compare_random(300, 4, 20260729);
  EXPECT_GT(tally.compared, 50U);
  EXPECT_GT(tally.refused, 50U);
  EXPECT_GT(tally.found, 20U);
}

TEST_F(Twins, equal_workers_are_exchanged_and_the_same_histories_judged) {
  for (const char* shape : {"ED|ED|ED", "E:D|D|E", "E|E|D|D", "EE:ED|ED"}) {
    const checker::Result all = check("even", shape, false);
    const checker::Result some = check("even", shape, true);
    EXPECT_TRUE(all.finished && some.finished) << shape;
    EXPECT_FALSE(some.finding) << shape << ": " << some.finding->text;
    EXPECT_EQ(all.exchanged.orders, 1U) << shape;
    EXPECT_GT(some.exchanged.orders, 1U) << shape << ": " << some.uneven;
    EXPECT_LE(some.complete * 2, all.complete + some.exchanged.orders) << shape;
    EXPECT_EQ(some.histories.size(), all.histories.size()) << shape;
  }
}

TEST_F(Twins, the_fault_of_one_worker_is_found) {
  for (const char* queue : {"third-worker", "rare-worker"})
    for (const bool symmetry : {false, true}) {
      const checker::Result result = check(queue, "ED|ED|ED", symmetry);
      ASSERT_TRUE(result.finding) << queue;
      EXPECT_EQ(result.finding->kind, checker::FindingKind::wrong_outcome) << queue;
    }
  // Where the worker does not come that far, nothing is lost.
  EXPECT_FALSE(check("third-worker", "ED|ED", true).finding);
}

TEST_F(Twins, workers_that_a_scan_tells_apart_are_not_exchanged) {
  const checker::Result result = check("order-of-scan", "ED|ED|ED", true);
  EXPECT_TRUE(result.finished);
  EXPECT_FALSE(result.finding);
  EXPECT_NE(result.uneven, "");
  EXPECT_EQ(result.exchanged.orders, 1U);
  EXPECT_EQ(result.complete, check("order-of-scan", "ED|ED|ED", false).complete);
}

TEST_F(Twins, parts_agree_on_whether_threads_are_equal) {
  for (const char* queue : {"even", "order-of-scan"}) {
    const checker::Result alone = check(queue, "EDE|EDE|EDE", true);
    const checker::Result parts = check(queue, "EDE|EDE|EDE", true, 3);
    EXPECT_TRUE(parts.finished) << queue;
    EXPECT_EQ(parts.complete, alone.complete) << queue;
    EXPECT_EQ(parts.uneven, alone.uneven) << queue;
    EXPECT_EQ(parts.histories.size(), alone.histories.size()) << queue;
  }
}
