// What `irt check` does to a queue by itself: ages it, lets memory run out, draws shapes, and says
// what came of it.

#include <gtest/gtest.h>
#include <stdexcept>

#include "stress/checker/progress.hpp"
#include "stress/checker/queue_check.hpp"
#include "stress/checker/queue_client.hpp"
#include "stress/checker/verdict.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {
namespace {

class DefaultCheck : public testing::Test {
 protected:
  const QueueEntry& entry(std::string_view name) { return probe_entry(module_, name); }

  QueueResult check(std::string_view queue, CheckSettings settings) {
    settings.quiet = true;
    return check_queue(entry(queue), module_, settings, "irt check");
  }

  Result check_shape(std::string_view queue, const char* shape,
                     std::shared_ptr<AgedMemory> aged = nullptr) {
    QueueClient client(entry(queue), parse_shape(shape), 0, &module_, false, std::move(aged));
    return checker::check(client.program(), {});
  }

  static const ShapeResult* found(const QueueResult& result) {
    for (const ShapeResult& shape : result.shapes)
      if (shape.result.finding) return &shape;
    return nullptr;
  }

  virtual_cores::Module module_{IRT_CASES_PROBE};
};

TEST_F(DefaultCheck, finds_counters_that_wrap_by_what_they_overwrite) {
  for (const char* queue : {"narrow-index-bug", "narrow-index-16-bug"}) {
    const QueueResult result = check(queue, {.seconds = 60});
    const ShapeResult* shape = found(result);
    ASSERT_NE(shape, nullptr) << queue;
    EXPECT_EQ(parse_shape(shape->shape).capacity, 3U) << shape->shape;
    EXPECT_GT(parse_shape(shape->shape).age, 100U) << shape->shape;
    EXPECT_EQ(shape->result.finding->text.find("full"), std::string::npos)
        << shape->result.finding->text;
    EXPECT_NE(shape->report.find(shape->shape), std::string::npos) << "how to see it again";
  }
}

TEST_F(DefaultCheck, ages_once_and_gives_each_execution_a_copy) {
  const auto aged = std::make_shared<AgedMemory>();
  const Result young = check_shape("narrow-index-fixed", "EE:DD|E@3");
  const Result old = check_shape("narrow-index-fixed", "EE:DD|E@3+65534", aged);
  EXPECT_TRUE(old.finished) << old.incomplete;
  EXPECT_FALSE(old.finding) << old.finding->text;
  EXPECT_EQ(old.executions, young.executions);
  EXPECT_EQ(aged->age, 65'534U);
  // A younger one begins anew, an older one goes on, and each comes to the same as alone.
  for (const char* shape : {"F:DD|EE@3+250", "F:DD|EE@3+254", "F:DD|EE@3+510"}) {
    const Result shared = check_shape("narrow-index-bug", shape, aged);
    EXPECT_EQ(shared.finding.has_value(),
              check_shape("narrow-index-bug", shape).finding.has_value())
        << shape;
  }
  EXPECT_TRUE(check_shape("narrow-index-bug", "F:DD|EE@3+254").finding);
  EXPECT_FALSE(check_shape("narrow-index-bug", "F:DD|EE@3+248").finding);
  EXPECT_TRUE(check_shape("narrow-index-bug", "(ED)*254 EEE:DDD@3").finding) << "made step by step";
}

TEST_F(DefaultCheck, says_which_allocation_failed) {
  const QueueResult result = check("failed-growth-bug", {.seconds = 60});
  const ShapeResult* shape = found(result);
  ASSERT_NE(shape, nullptr);
  EXPECT_EQ(shape->result.finding->kind, FindingKind::livelock);
  EXPECT_EQ(shape->search, poor_search);
  EXPECT_NE(shape->report.find("There was no memory for what thread"), std::string::npos)
      << shape->report;
  EXPECT_NE(shape->report.find("--failing-allocations 1"), std::string::npos) << shape->report;
  EXPECT_FALSE(
      check("failed-growth-bug", {.seconds = 1, .no_memory = false, .generated = 0}).found);
}

TEST_F(DefaultCheck, tries_shapes_beyond_the_battery_and_counts_what_it_proved) {
  const QueueResult result = check("narrow-index-fixed", {.seconds = 30, .generated = 20});
  EXPECT_EQ(found(result), nullptr) << found(result)->shape << found(result)->report;
  std::size_t generated = 0;
  std::size_t aged = 0;
  for (const ShapeResult& shape : result.shapes) {
    if (!searched_whole(shape)) continue;
    generated += shape.origin == Origin::generated ? 1 : 0;
    aged += shape.origin == Origin::aged && shape.proved ? 1 : 0;
  }
  EXPECT_EQ(generated, 20U);
  EXPECT_GT(aged, 10U);
  const std::string text = verdict("fixed", result);
  EXPECT_NE(text.find("of 20 generated shapes"), std::string::npos) << text;
  EXPECT_NE(text.find("nothing found"), std::string::npos) << text;
}

TEST_F(DefaultCheck, says_nothing_is_proved_where_code_is_not_seen) {
  QueueResult result = check("narrow-index-fixed", {.seconds = 1, .generated = 0});
  EXPECT_NE(verdict("q", result).find("Proved: "), std::string::npos);
  result.unseen.unproved = "it calls compiled code";
  EXPECT_EQ(verdict("q", result).find("Proved: "), std::string::npos);
  EXPECT_NE(verdict("q", result).find("it calls compiled code"), std::string::npos);
}

TEST_F(DefaultCheck, stops_at_the_first_finding_or_collects_distinct_ones) {
  CheckSettings settings{.shapes = {"E|D", "EE|DD", "E:D|E"}, .seconds = 10};
  QueueResult first = check("unpublished-bug", settings);
  std::size_t findings = 0;
  for (const ShapeResult& shape : first.shapes) findings += shape.result.finding ? 1 : 0;
  EXPECT_EQ(findings, 1U);
  settings.keep_going = true;
  const QueueResult all = check("unpublished-bug", settings);
  EXPECT_TRUE(all.found);
  std::vector<Finding> distinct;
  for (const ShapeResult& shape : all.shapes) {
    if (!shape.result.finding) {
      EXPECT_FALSE(shape.proved && shape.shape == "E|D") << "a shape with a finding is not proved";
      continue;
    }
    for (const Finding& other : distinct)
      EXPECT_FALSE(same_place(other, *shape.result.finding)) << other.text;
    distinct.push_back(*shape.result.finding);
    EXPECT_NE(shape.report.find("replay: "), std::string::npos);
  }
  EXPECT_GE(distinct.size(), 1U);
  EXPECT_GE(all.shapes.size(), 3U) << "the other shapes are tried as well";
}

TEST_F(DefaultCheck, destroys_queues_with_elements_inside) {
  for (const char* queue :
       {"dropped-list-uses-bug", "dropped-list-leaks-bug", "dropped-list-twice-bug",
        "dropped-ring-looks-bug", "dropped-ring-wipes-bug"}) {
    EXPECT_FALSE(check_shape(queue, "EE|D").finding) << queue << ", emptied";
    EXPECT_TRUE(check_shape(queue, "EE:S;X@2").finding) << queue;
  }
  for (const char* queue : {"dropped-list-fixed", "dropped-ring-fixed"})
    for (const char* shape : {"EE:S;X@2", "EE|D;X", "F:DE|E;X@3", "F:D|E;X@3+250"}) {
      const Result result = check_shape(queue, shape);
      EXPECT_TRUE(result.finished && !result.finding) << queue << " on " << shape;
    }
}

// Who makes a search, and how many do, changes nothing of what is told.
TEST_F(DefaultCheck, tells_the_same_whatever_number_of_processes_search) {
  const auto told = [&](std::string_view queue, CheckSettings settings, unsigned jobs) {
    settings.jobs = jobs;
    std::string all;
    for (const ShapeResult& s : check(queue, settings).shapes) {
      if (s.origin != Origin::generated && s.origin != Origin::clients) continue;
      all += s.shape + " " + s.search + " " + std::to_string(s.result.executions) + " " +
             std::to_string(s.histories) + (s.result.finished ? " whole " : " ") +
             (s.result.finding ? s.result.finding->text + s.report : "") + "\n";
    }
    return all;
  };
  const CheckSettings generated{.seconds = 60, .generated = 30};
  const CheckSettings clients{.seconds = 60, .all_clients = 3};
  for (const unsigned jobs : {2U, 3U}) {
    EXPECT_EQ(told("narrow-index-fixed", generated, jobs),
              told("narrow-index-fixed", generated, 1));
    EXPECT_EQ(told("narrow-index-fixed", clients, jobs), told("narrow-index-fixed", clients, 1));
    EXPECT_EQ(told("unpublished-bug", clients, jobs), told("unpublished-bug", clients, 1));
  }
  EXPECT_NE(told("unpublished-bug", clients, 2).find("replay: "), std::string::npos);
}

TEST_F(DefaultCheck, tries_every_client_of_few_calls) {
  const QueueResult result = check("narrow-index-fixed", {.seconds = 30, .all_clients = 3});
  EXPECT_EQ(found(result), nullptr) << found(result)->report;
  EXPECT_EQ(result.not_tried, 0U);
  EXPECT_NE(verdict("q", result).find("clients of at most 3 calls"), std::string::npos);
  const QueueResult late = check("narrow-index-fixed", {.seconds = 0, .all_clients = 3});
  EXPECT_GT(late.not_tried, 0U);
  EXPECT_NE(verdict("q", late).find("not tried"), std::string::npos);
}

}  // namespace
}  // namespace irt::checker
