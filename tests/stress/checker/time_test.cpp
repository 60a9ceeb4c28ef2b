// A check ends when its time is up, whatever the queue does with it, and says what it left out.

#include <chrono>
#include <ctime>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <string_view>

#include "stress/checker/queue_check.hpp"
#include "stress/checker/verdict.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {
namespace {

class Time : public testing::Test {
 protected:
  const QueueEntry& entry(std::string_view name) { return probe_entry(module_, name); }

  QueueResult check(std::string_view queue, CheckSettings settings) {
    settings.quiet = true;
    settings.reports = false;
    const auto start = std::chrono::steady_clock::now();
    QueueResult result = check_queue(entry(queue), module_, settings, "");
    taken_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  virtual_cores::Module module_{IRT_CASES_PROBE};
  double taken_ = 0;  ///< seconds, by the last check
};

// Two seconds, and as much again for a machine that has other things to do.
constexpr double late = 4;

TEST_F(Time, bounds_what_stops_threads) {
  for (const char* shape : {"E|D", "EE|DD"}) {
    CheckSettings settings{.shapes = {shape}, .seconds = 3};
    const QueueResult result = check("many-steps", settings);
    EXPECT_LT(taken_, settings.seconds + late) << shape;
    EXPECT_FALSE(result.found);
    EXPECT_EQ(result.shapes.back().search, stalls_search);
    EXPECT_FALSE(result.shapes.back().result.finished);
    const std::string text = verdict("many-steps", result);
    EXPECT_NE(text.find("Threads were not stopped before each of their steps, for time: " +
                        std::string(shape) + "."),
              std::string::npos)
        << text;
  }
}

TEST_F(Time, is_enough_for_what_is_short) {
  const QueueResult result = check("few-steps", {.shapes = {"E|D"}, .seconds = 20});
  EXPECT_EQ(result.shapes.back().search, stalls_search);
  EXPECT_TRUE(result.shapes.back().result.finished);
  const std::string text = verdict("", result);
  EXPECT_EQ(text.find("stopped"), std::string::npos) << text;
}

TEST_F(Time, bounds_the_battery) {
  CheckSettings settings{.seconds = 4};
  const QueueResult result = check("many-steps", settings);
  EXPECT_LT(taken_, settings.seconds + late);
  for (const ShapeResult& shape : result.shapes)
    EXPECT_TRUE(shape.result.finished || !shape.proved) << shape.shape;
}

// 4,000 seq_cst looks in a call, of which most could see what is old by then: under a second of
// this processor, where putting all of them in order anew at each look took 20.
TEST_F(Time, does_not_grow_with_the_square_of_seq_cst_looks) {
  const std::clock_t start = std::clock();
  const QueueResult result =
      check("patient", {.shapes = {"E|D"}, .search = Search::exhaustive, .seconds = 60});
  const double used = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_EQ(result.shapes.size(), 1U);
  EXPECT_TRUE(result.shapes[0].proved) << verdict("patient", result);
  EXPECT_LT(used, 3);
}

// Whether 2^64 rounds of a counter end nobody can know: they are no fault, and no proof.
TEST_F(Time, bounds_computation_that_may_have_no_end) {
  for (const double seconds : {3.0, 8.0}) {
    CheckSettings settings{.shapes = {"E|D"}, .seconds = seconds};
    const QueueResult result = check("endless-count", settings);
    EXPECT_LT(taken_, seconds + late);
    EXPECT_FALSE(result.found);
    for (const ShapeResult& shape : result.shapes) EXPECT_FALSE(shape.proved);
    if (seconds < 5) continue;  // a busy machine may give it too little of that to say why
    const std::string text = verdict("", result);
    EXPECT_NE(text.find(" in one call without an event at endless.hpp:"), std::string::npos)
        << text;
  }
}

TEST_F(Time, bounds_looks_at_the_clock) {
  const QueueResult result = check("waits-by-the-clock", {.shapes = {"E|D"}, .seconds = 2});
  EXPECT_LT(taken_, 2 + late);
  EXPECT_FALSE(result.found);
  for (const ShapeResult& shape : result.shapes) EXPECT_FALSE(shape.proved);
}

// An execution of it takes three seconds and more, and so does each of six that come before.
TEST_F(Time, is_no_reason_to_accuse_what_computes_for_long) {
  const QueueResult result = check("computes-long", {.shapes = {"E|D"}, .seconds = 12});
  EXPECT_FALSE(result.found);
  const std::string text = verdict("", result);
  EXPECT_EQ(text.find("Proved: 1"), std::string::npos) << text;
}

TEST_F(Time, bounds_the_ageing_of_queues) {
  CheckSettings settings{.seconds = 3};
  settings.old = true;
  const QueueResult result = check("narrow-index-fixed", settings);
  EXPECT_LT(taken_, settings.seconds + late);
  bool aged = false;
  for (const ShapeResult& shape : result.shapes) {
    if (shape.origin != Origin::aged) continue;
    aged = true;
    EXPECT_FALSE(shape.result.finished) << shape.shape << ": no machine is that fast";
    EXPECT_FALSE(shape.proved) << shape.shape;
  }
  EXPECT_TRUE(aged);
}

}  // namespace
}  // namespace irt::checker
