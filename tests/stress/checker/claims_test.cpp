// What claims mean to `irt check`: answers that are wrong whatever the order, answers that are
// right where no more is claimed, and nobody who acts in another's part.

#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <string_view>

#include "stress/checker/queue_check.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {
namespace {

class ClaimsTest : public testing::Test {
 protected:
  const QueueEntry& entry(std::string_view name) { return probe_entry(module_, name); }

  /// What one shape, searched whole, brings to light; empty if nothing.
  std::string finding(std::string_view queue, std::string_view shape) {
    QueueClient client(entry(queue), parse_shape(shape), 0, &module_);
    const Result result = check(client.program(), {.seconds = 20});
    EXPECT_TRUE(result.finished || result.finding) << queue << " on " << shape;
    return result.finding ? result.finding->text : "";
  }

  /// The same of the battery, with threads that are stopped.
  std::string in_battery(std::string_view queue) {
    CheckSettings settings;
    settings.quiet = true;
    settings.reports = false;
    settings.seconds = 20;
    settings.generated = 60;
    for (const ShapeResult& shape : check_queue(entry(queue), module_, settings, "").shapes)
      if (shape.result.finding)
        return std::string(name_of(shape.result.finding->kind)) + " on " + shape.shape + ": " +
               shape.result.finding->text;
    return "";
  }

  virtual_cores::Module module_{IRT_CLAIMS_PROBE};
};

TEST_F(ClaimsTest, the_bound_is_judged_whatever_the_order) {
  for (const char* queue :
       {"one-short-bug", "one-short-producers-bug", "one-short-unordered-bug"}) {
    EXPECT_NE(finding(queue, "F:D@1").find("\"full\""), std::string::npos) << queue;
    EXPECT_NE(in_battery(queue).find("\"full\""), std::string::npos) << queue;
  }
  EXPECT_EQ(finding("one-short-fixed", "F:D@1"), "");
  EXPECT_NE(in_battery("short-at-first-bug").find("\"full\""), std::string::npos);
}

TEST_F(ClaimsTest, what_is_not_published_is_a_race) {
  EXPECT_NE(in_battery("unpublished-bug").find("does not publish"), std::string::npos);
  EXPECT_EQ(in_battery("unpublished-fixed"), "");
}

TEST_F(ClaimsTest, empty_is_judged_where_no_call_in_flight_explains_it) {
  EXPECT_NE(in_battery("half-blind-bug").find("wrong outcome"), std::string::npos);
  EXPECT_EQ(in_battery("half-blind-fixed"), "");
  const std::string text = finding("half-blind-bug", "ED:ED@2");
  EXPECT_NE(text.find("\"empty\" while"), std::string::npos) << text;
}

// Thread 1 finds nothing, so that what was inside is gone, and then no place.
TEST_F(ClaimsTest, full_may_count_a_pop_in_flight_where_that_is_claimed) {
  const std::string text = finding("credited-exact", "E:D|DE@1");
  EXPECT_NE(text.find("\"full\""), std::string::npos) << text;
  EXPECT_EQ(finding("credited-in-flight", "E:D|DE@1"), "");
  EXPECT_EQ(in_battery("credited-in-flight"), "");
  // Without anybody in flight it is as wrong as ever.
  EXPECT_EQ(finding("credited-in-flight", "F:D@2"), "");
}

TEST_F(ClaimsTest, empty_may_speak_for_one_worker_where_that_is_claimed) {
  const std::string text = finding("hoarding-boast", "EE:DS|WD");
  EXPECT_NE(text.find("\"empty\" while"), std::string::npos) << text;
  EXPECT_EQ(finding("hoarding-honest", "EE:DS|WD"), "");
  EXPECT_EQ(in_battery("hoarding-honest"), "");
  EXPECT_EQ(in_battery("leaves-one"), "");
}

TEST_F(ClaimsTest, words_workers_and_memory_are_as_the_queue_wants_them) {
  EXPECT_EQ(in_battery("picky"), "");
  EXPECT_EQ(finding("picky", "EEED|ED@4"), "");
  EXPECT_THROW(finding("picky", "E|E|D"), std::invalid_argument);
}

TEST_F(ClaimsTest, nobody_acts_for_another_or_for_who_was_stopped) {
  for (const char* queue : {"knows-its-workers", "knows-its-consumer", "knows-each-worker"})
    EXPECT_EQ(in_battery(queue), "") << queue;
  // The consumer is the first thread, then the last; the prologue pops, too.
  for (const char* shape : {"D|E", "E|D", "EED:E|D"})
    EXPECT_EQ(finding("knows-its-workers", shape), "") << shape;
}

}  // namespace
}  // namespace irt::checker
