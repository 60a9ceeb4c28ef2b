// Whole queues by shapes: proofs for healthy ones, findings for faults, and how much work it is.

#include <csignal>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <utility>

#include "stress/checker/batteries.hpp"
#include "stress/checker/parts.hpp"
#include "stress/checker/progress.hpp"
#include "stress/checker/queue_client.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace {

namespace checker = irt::checker;

class Queues : public testing::Test {
 protected:
  const irt::QueueEntry& entry(std::string_view name) {
    return checker::probe_entry(module_, name);
  }

  checker::Result check(std::string_view queue, std::string_view shape,
                        const checker::Options& options) {
    checker::QueueClient client(entry(queue), checker::parse_shape(shape), 2, &module_);
    return checker::check(client.program(), options);
  }

  /// The first finding in the battery; no kind if there is none.
  std::pair<std::string, std::string> first_finding(std::string_view queue,
                                                    const checker::Options& options) {
    for (const std::string& shape : checker::battery(entry(queue).claims)) {
      const checker::Result result = check(queue, shape, options);
      if (result.finding) return {std::string(name_of(result.finding->kind)), shape};
    }
    return {};
  }

  irt::virtual_cores::Module module_{IRT_QUEUES_PROBE};
};

}  // namespace

TEST_F(Queues, the_healthy_one_is_proved_with_fewer_executions_than_other_checkers_need) {
  // Others' figures for the same clients: loom 571 and 306,547, GenMC 178 for the first.
  const checker::Result two = check("healthy", "ED|ED", {});
  EXPECT_TRUE(two.finished);
  EXPECT_FALSE(two.finding) << two.finding->text;
  EXPECT_LT(two.executions, 178U);
  const checker::Result three = check("healthy", "E|D|E", {});
  EXPECT_TRUE(three.finished);
  EXPECT_FALSE(three.finding) << three.finding->text;
  EXPECT_LT(three.executions, 306'547U);
  RecordProperty("executions_two", static_cast<int>(two.executions));
  RecordProperty("executions_three", static_cast<int>(three.executions));
}

TEST_F(Queues, healthy_ones_pass_the_battery) {
  for (const char* queue : {"healthy", "honest-ring"})
    EXPECT_EQ(first_finding(queue, {.executions = 3000}).first, "") << queue;
}

TEST_F(Queues, faults_are_found_exhaustively) {
  const std::pair<const char*, const char*> faults[] = {
      {"relaxed-publish", "data race"}, {"relaxed-head", "wrong outcome"},
      {"value-after-cas", "data race"}, {"delete-now", "use after free"},
      {"no-help", "livelock"},          {"two-locks", "data race"}};
  for (const auto& [queue, kind] : faults)
    EXPECT_EQ(first_finding(queue, {.seconds = 20}).first, kind) << queue;
}

// Its elements leave once, whatever its orders; what they point to needs both.
TEST_F(Queues, what_an_element_points_to_is_published_or_a_race_is_found) {
  EXPECT_EQ(first_finding("publishing-bag", {}).first, "");
  for (const char* queue : {"unpublished-bag", "half-published-bag"})
    for (const char* shape : {"E|D", "E|R", "EE|DD"}) {
      const checker::Result result = check(queue, shape, {});
      ASSERT_TRUE(result.finding) << queue << " on " << shape;
      EXPECT_EQ(result.finding->kind, checker::FindingKind::data_race);
      EXPECT_NE(result.finding->text.find("does not publish its elements"), std::string::npos)
          << result.finding->text;
    }
  EXPECT_FALSE(check("unpublished-bag", "E:D|D", {}).finding) << "threads see the prologue";
  checker::Options ignoring;
  ignoring.limits.races = false;
  EXPECT_FALSE(check("unpublished-bag", "E|D", ignoring).finding);
}

TEST_F(Queues, faults_are_found_by_samples_whatever_the_seed) {
  for (const char* queue : {"relaxed-publish", "relaxed-head", "delete-now", "two-locks"})
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      EXPECT_NE(
          first_finding(queue, {.search = checker::Search::pos, .seed = seed, .executions = 3000})
              .first,
          "")
          << queue << " with seed " << seed;
}

TEST_F(Queues, a_stopped_producer_blocks_a_ring_and_no_linked_queue) {
  const auto stalls = [this](std::string_view queue) {
    checker::QueueClient client(entry(queue), checker::parse_shape("E|E|D"), 2, &module_);
    return check_progress(client.program(), {}, 1, 6, 60);
  };
  const checker::ProgressResult ring = stalls("boastful-ring");
  ASSERT_TRUE(ring.finding);
  EXPECT_EQ(ring.finding->kind, checker::FindingKind::blocked_by_stalled_thread);
  const checker::ProgressResult linked = stalls("healthy");
  EXPECT_FALSE(linked.finding) << linked.finding->text;
  EXPECT_GT(linked.executions, 20U);
}

TEST_F(Queues, a_clock_shows_what_happens_before_does_not) {
  const auto timed = [this](std::string_view queue, std::string_view shape) {
    checker::QueueClient client(entry(queue), checker::parse_shape(shape), 2, &module_, true);
    return checker::check(client.program(), {});
  };
  // Its "empty" may be old news, which it does not deny.
  const checker::Result linked = timed("healthy", "E|D");
  ASSERT_TRUE(linked.finding);
  EXPECT_NE(linked.finding->text.find("real time"), std::string::npos) << linked.finding->text;
  for (const char* shape : {"E|D", "E:D|D", "ED|ED", "E|D|D"}) {
    const checker::Result locked = timed("locked", shape);
    EXPECT_TRUE(locked.finished) << shape;
    EXPECT_FALSE(locked.finding) << shape << ": " << locked.finding->text;
  }
}

// A client that asks for little gets rings of two places: they go round, are closed and left, and
// pops wait for pushes and make places unsafe.
TEST_F(Queues, linked_rings_are_proved_by_the_clock) {
  for (const char* shape : {"E|D", "E:D|D", "ED|ED", "E:E|D|E", "EE:DD|ED", "EEE:DD|D"})
    for (const char* queue : {"lcrq", "boxed-lcrq"}) {
      checker::QueueClient client(entry(queue), checker::parse_shape(shape), 2, &module_, true);
      const checker::Result result = checker::check(client.program(), {});
      EXPECT_TRUE(result.finished) << shape;
      EXPECT_FALSE(result.finding) << shape << ": " << result.finding->text;
    }
}

TEST_F(Queues, what_is_lost_for_want_of_memory_is_found) {
  checker::Options options;
  options.limits.failing_allocations = 1;
  for (const char* queue : {"healthy", "locked"}) {
    const checker::Result sound = check(queue, "ED|D", options);
    EXPECT_TRUE(sound.finished) << queue;
    EXPECT_FALSE(sound.finding) << queue << ": " << sound.finding->text;
  }
  EXPECT_FALSE(check("forgetful", "ED|D", {}).finding);
  const checker::Result forgetful = check("forgetful", "ED|D", options);
  ASSERT_TRUE(forgetful.finding);
  EXPECT_NE(forgetful.finding->text.find("never came out"), std::string::npos)
      << forgetful.finding->text;
}

TEST_F(Queues, parts_of_the_work_add_up) {
  const checker::Result whole = check("healthy", "ED|ED|D", {.symmetry = false});
  std::uint64_t sum = 0;
  for (unsigned shard = 0; shard < 3; ++shard) {
    const checker::Result part =
        check("healthy", "ED|ED|D", {.shard = shard, .shards = 3, .symmetry = false});
    EXPECT_TRUE(part.finished);
    EXPECT_LT(part.complete, whole.complete);
    sum += part.complete;
  }
  EXPECT_EQ(sum, whole.complete);
}

TEST_F(Queues, processes_share_the_work_and_add_it_up) {
  checker::QueueClient client(entry("healthy"), checker::parse_shape("ED|EDD|D"), 2, &module_);
  const checker::Result whole = checker::check(client.program(), {});
  const checker::Result parts = checker::check_in_parts(client.program(), {}, 3);
  ASSERT_GT(whole.executions, 4096U) << "too few to be worth several processes";
  EXPECT_TRUE(parts.finished);
  EXPECT_EQ(parts.complete, whole.complete);
  EXPECT_EQ(parts.blocked, whole.blocked);
  EXPECT_EQ(parts.histories.size(), whole.histories.size());
}

// About one execution in 3,000 fails, whichever process makes it.
TEST_F(Queues, processes_agree_on_what_they_have_found) {
  checker::QueueClient client(entry("healthy"), checker::parse_shape("ED|EDD|D"), 2, &module_);
  checker::Program checked = client.program();
  checked.judge = [](const checker::Execution& execution) -> std::optional<std::string> {
    const std::string steps = to_string(checker::Schedule{execution.steps(), true});
    if (std::hash<std::string>{}(steps) % 3000 != 7) return std::nullopt;
    return steps;
  };
  for (const checker::Search search : {checker::Search::exhaustive, checker::Search::random}) {
    const checker::Options options{.search = search, .executions = 200'000};
    const checker::Result first = checker::check_in_parts(checked, options, 3);
    ASSERT_TRUE(first.finding);
    for (int again = 0; again < 3; ++again) {
      const checker::Result result = checker::check_in_parts(checked, options, 3);
      ASSERT_TRUE(result.finding);
      EXPECT_EQ(result.finding->text, first.finding->text);
      EXPECT_EQ(result.schedule.steps, first.schedule.steps);
    }
  }
}

TEST_F(Queues, a_process_that_crashes_is_no_verdict) {
  checker::QueueClient client(entry("healthy"), checker::parse_shape("ED|EDD|D"), 2, &module_);
  checker::Program checked = client.program();
  checked.judge = [&, made = 0](const checker::Execution&) mutable -> std::optional<std::string> {
    if (++made == 9000) std::raise(SIGKILL);
    return std::nullopt;
  };
  try {
    checker::check_in_parts(checked, {}, 2);
    FAIL() << "a crash was swallowed";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("crashed: signal 9"), std::string::npos)
        << error.what();
  }
}

TEST(Judge, orders_operations_by_happens_before_only) {
  using QueueCall = checker::QueueCall;
  const irt::Claims fifo{.ordering = irt::Ordering::fifo_happens_before};
  QueueCall push{.kind = QueueCall::Kind::push, .thread = 0, .answered = true, .finished = true};
  push.value = 7;
  push.returned = 3;
  QueueCall empty{.kind = QueueCall::Kind::pop, .thread = 1, .finished = true};
  QueueCall pop{.kind = QueueCall::Kind::pop, .thread = 2, .answered = true, .finished = true};
  pop.value = 7;
  pop.phase = QueueCall::Phase::after;
  EXPECT_FALSE(checker::judge({push, empty, pop}, fifo, 1).wrong) << "the push may come later";
  empty.called.count[0] = 3;
  EXPECT_TRUE(checker::judge({push, empty, pop}, fifo, 1).wrong) << "the push happens before";
  EXPECT_TRUE(checker::judge({push, pop, pop}, fifo, 1).wrong) << "popped twice";
  EXPECT_TRUE(checker::judge({push}, fifo, 1).wrong) << "lost";
}
