#include "bench/contention/plan.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

/// Two packages of two caches with two cores of two hardware threads. As on many machines, the
/// system numbers all cores first and then their siblings.
Machine machine() {
  Machine all;
  all.knows_caches = true;
  for (unsigned core = 0; core < 8; ++core) {
    for (unsigned sibling = 0; sibling < 2; ++sibling) {
      all.processors.push_back({.number = core + 8 * sibling,
                                .package = core / 4,
                                .numa_node = core / 4,
                                .cache = core / 2,
                                .core = core,
                                .sibling = sibling});
    }
  }
  return all;
}

using Numbers = std::vector<unsigned>;

TEST(Placement, EachPolicyOnAMachineThatHasEveryLevel) {
  const auto first_eight = [](const char* policy) {
    const Placement placement = place(policy, machine());
    EXPECT_EQ(placement.text, policy);
    std::set<unsigned> all(placement.processors.begin(), placement.processors.end());
    EXPECT_EQ(all.size(), 16U);
    return Numbers(placement.processors.begin(), placement.processors.begin() + 8);
  };
  EXPECT_EQ(first_eight("close"), (Numbers{0, 1, 8, 9, 2, 3, 10, 11}));
  EXPECT_EQ(first_eight("smt-first"), (Numbers{0, 8, 1, 9, 2, 10, 3, 11}));
  EXPECT_EQ(first_eight("smt-last"), (Numbers{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(first_eight("far"), (Numbers{0, 4, 2, 6, 1, 5, 3, 7}));
  EXPECT_EQ(first_eight("one-per-l3"), (Numbers{0, 2, 4, 6, 1, 3, 5, 7}));
  EXPECT_EQ(first_eight("numa-spread"), (Numbers{0, 4, 1, 5, 2, 6, 3, 7}));
  EXPECT_TRUE(place("none", machine()).processors.empty());
}

TEST(Placement, WhatAMachineLacksIsSaid) {
  Machine plain;
  for (unsigned i = 0; i < 2; ++i) plain.processors.push_back({.number = i, .core = i});
  EXPECT_NE(place("one-per-l3", plain).text, "one-per-l3");
  EXPECT_NE(place("numa-spread", plain).text, "numa-spread");
  EXPECT_NE(place("smt-first", plain).text, "smt-first");
  EXPECT_EQ(place("close", plain).text, "close");
  EXPECT_EQ(place("numa-spread", plain).processors, (Numbers{0, 1}));
}

TEST(Placement, ThisMachineCanBeRead) {
  const Machine here = survey_machine();
  ASSERT_FALSE(here.processors.empty());
  std::set<unsigned> numbers;
  for (const Processor& one : here.processors) numbers.insert(one.number);
  EXPECT_EQ(numbers.size(), here.processors.size());
}

TEST(Scenarios, CastsAddUp) {
  for (const Scenario& scenario : scenarios()) {
    for (unsigned threads = scenario.least_threads; threads <= 9; ++threads) {
      const Roles roles = scenario.roles(threads);
      EXPECT_LE(roles.workers, threads) << scenario.name;
      EXPECT_GE(roles.producers, 1U) << scenario.name;
      EXPECT_GE(roles.consumers, 1U) << scenario.name;
      if (!roles.together()) {
        EXPECT_EQ(roles.producers + roles.consumers, roles.workers) << scenario.name;
      }
    }
  }
  const Roles three_to_one = scenario_at("3x1").roles(99);
  EXPECT_EQ(three_to_one.workers, 4U);
  EXPECT_EQ(three_to_one.producers, 3U);
  EXPECT_EQ(scenario_at("3x1").name(), "3x1");
}

TEST(Scenarios, OnlyWhatTheClaimsAllow) {
  const Claims one_producer{.producers = Callers::one};
  const Claims own{.producers = Callers::own_worker, .consumers = Callers::own_worker};
  EXPECT_EQ(obstacle(scenario_at("fan-out").roles(4), one_producer), "");
  EXPECT_NE(obstacle(scenario_at("fan-in").roles(4), one_producer), "");
  EXPECT_EQ(obstacle(scenario_at("pairs").roles(4), own), "");
  EXPECT_NE(obstacle(scenario_at("1x1").roles(2), own), "");
  EXPECT_NE(obstacle(scenario_at("ping-pong").roles(2), own), "");
  EXPECT_EQ(obstacle(scenario_at("8x8").roles(2), Claims{}), "");
}

TEST(Plan, BaselinesAreThereByDefaultAndByTheirName) {
  const QueueRegistry queues;
  Plan all;
  settle(all, queues, machine());
  Plan two;
  two.queues = {"lock", "baselines"};
  settle(two, queues, machine());
  EXPECT_EQ(std::set<std::string>(two.queues.begin(), two.queues.end()),
            (std::set<std::string>{"lock", "faa", "cas", "delay", "mutex"}));
  for (const std::string& name : two.queues) {
    EXPECT_EQ(std::ranges::count(all.queues, name), 1) << name;
  }
  two.scenarios = {"renderer"};
  const Rows rows = rows_of(two, queues, machine());
  EXPECT_EQ(rows.left_out.size(), 3U);
  for (const Row& row : rows.rows) {
    EXPECT_TRUE(row.queue == "lock" || row.queue == "mutex") << row.queue;
    EXPECT_TRUE(row.claims.is_object());
  }
}

TEST(Plan, CountingIsAPassOfTheFirstRepetitionWhereAQueueCanCount) {
  Plan plan;
  plan.latency = true;
  Row row;
  EXPECT_EQ(passes_of(plan, row, 0), (std::vector{Pass::plain, Pass::stamped, Pass::counted}));
  EXPECT_EQ(passes_of(plan, row, 1), (std::vector{Pass::plain, Pass::stamped}));
  plan.order = true;
  row.scenario = "pairs";
  EXPECT_EQ(passes_of(plan, row, 1), (std::vector{Pass::plain, Pass::stamped, Pass::logged}));
  row.scenario = "ping-pong";
  row.not_countable = "a reason";
  EXPECT_EQ(passes_of(plan, row, 0), (std::vector{Pass::plain, Pass::stamped}));
}

Plan plan_of_many() {
  Plan plan;
  plan.queues = {"lock", "local", "mutex"};
  plan.scenarios = {"pairs", "fan-in", "2x3"};
  plan.threads = {1, 2, 3, 32};
  plan.work = {0, 100};
  plan.placements = {"close", "none"};
  return plan;
}

std::string text_of(const Row& row) {
  return row.queue + ' ' + row.scenario + ' ' + std::to_string(row.cast.workers) + ' ' +
         std::to_string(row.work_ns) + ' ' + row.placement.text;
}

TEST(Plan, EveryCombinationThatTheClaimsAllowOnce) {
  const QueueRegistry queues;
  Plan plan = plan_of_many();
  plan.queues.emplace_back("lock");  // twice
  settle(plan, queues, machine());
  const Rows all = rows_of(plan, queues, machine());
  std::set<std::string> rows;
  for (const Row& row : all.rows) {
    EXPECT_TRUE(rows.insert(text_of(row)).second) << text_of(row);
    EXPECT_EQ(row.oversubscribed, row.cast.workers == 32) << text_of(row);
  }
  // pairs: 3 queues, 4 thread counts; fan-in: 2 queues, 3 counts; 2x3: 2 queues; times 4.
  EXPECT_EQ(rows.size(), (3 * 4 + 2 * 3 + 2) * 4U);
  EXPECT_EQ(all.left_out.size(), 2U);
  EXPECT_NE(all.left_out[0].find("local"), std::string::npos);
}

TEST(Plan, ShardsAreDisjointAndComplete) {
  const QueueRegistry queues;
  Plan plan = plan_of_many();
  settle(plan, queues, machine());
  std::multiset<std::string> whole, parts;
  for (const Row& row : rows_of(plan, queues, machine()).rows) whole.insert(text_of(row));
  plan.shards = 5;
  for (plan.shard = 0; plan.shard < plan.shards; ++plan.shard) {
    const Rows part = rows_of(plan, queues, machine());
    for (const Row& row : part.rows) {
      parts.insert(text_of(row));
      EXPECT_EQ(row.cell % 5, plan.shard);
    }
  }
  EXPECT_EQ(whole, parts);
}

TEST(Plan, QueuesOfACellTakeTurnsInAnOrderOfTheirOwn) {
  const QueueRegistry queues;
  Plan plan = plan_of_many();
  settle(plan, queues, machine());
  const std::vector<Row> rows = rows_of(plan, queues, machine()).rows;
  std::set<std::vector<unsigned>> orders;
  for (unsigned repetition = 0; repetition < 20; ++repetition) {
    const auto order = order_of(rows, repetition, 1);
    EXPECT_EQ(order, order_of(rows, repetition, 1));
    orders.insert(order);
    ASSERT_EQ(order.size(), rows.size());
    auto sorted = order;
    std::ranges::sort(sorted);
    for (unsigned i = 0; i < sorted.size(); ++i) {
      ASSERT_EQ(sorted[i], i);
      ASSERT_EQ(rows[order[i]].cell, rows[i].cell);  // cell by cell
    }
  }
  EXPECT_GE(orders.size(), 19U);
}

TEST(Plan, LinesOfACellTakeTurnsAsManyAsFit) {
  std::vector<Row> rows(40);
  for (unsigned i = 0; i < rows.size(); ++i) rows[i].cell = i < 3 ? 0 : i < 20 ? 1 : 2;
  const auto order = order_of(rows, 0, 1);
  std::vector<std::size_t> sizes;
  std::vector<unsigned> all;
  for (const auto& group : groups_of(order, rows, 1e12)) {
    sizes.push_back(group.size());
    all.insert(all.end(), group.begin(), group.end());
    for (const unsigned row : group) EXPECT_EQ(rows[row].cell, rows[group.front()].cell);
  }
  EXPECT_EQ(sizes, (std::vector<std::size_t>{3, 8, 9, 10, 10}));
  EXPECT_EQ(all, order);
  // Without memory each goes by itself.
  EXPECT_EQ(groups_of(order, rows, 0).size(), rows.size());
  Row large;
  large.capacity = 1 << 30;
  EXPECT_EQ(most_together(large, 1e12), 7U);
}

TEST(Plan, OnlyRatesAreTakenInTurns) {
  const Plan plan;
  EXPECT_GT(job_of(plan, {}, 0, {}, Pass::plain).turns, 1U);
  Row crowded;
  crowded.cast.workers = 3;
  crowded.placement.processors = {0, 1};
  EXPECT_LT(job_of(plan, crowded, 0, {}, Pass::plain).turns,
            job_of(plan, {}, 0, {}, Pass::plain).turns);
  EXPECT_EQ(job_of(plan, {}, 0, {}, Pass::stamped).turns, 1U);
  EXPECT_EQ(job_of(plan, {}, 0, {}, Pass::counted).turns, 1U);
}

TEST(Plan, RepetitionsHaveSeedsOfTheirOwnThatQueuesShare) {
  const Plan plan = plan_of_many();
  Row lock, mutex;
  lock.cell = mutex.cell = 3;
  lock.queue = "lock";
  mutex.queue = "mutex";
  EXPECT_EQ(job_of(plan, lock, 1, {}, Pass::plain).seed,
            job_of(plan, mutex, 1, {}, Pass::plain).seed);
  EXPECT_NE(job_of(plan, lock, 1, {}, Pass::plain).seed,
            job_of(plan, lock, 2, {}, Pass::plain).seed);
}

TEST(Plan, ACapacityBelowTheThreadsIsRefused) {
  const QueueRegistry queues;
  Plan plan = plan_of_many();
  plan.capacities = {16};
  EXPECT_THROW(settle(plan, queues, machine()), UsageError);
}

}  // namespace
}  // namespace irt::contention
