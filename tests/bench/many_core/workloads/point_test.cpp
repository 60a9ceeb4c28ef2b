/// What can be known of simulated runs without a machine: closed forms, conservation, determinism.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/bench/many_core/simulated_run.hpp"

namespace irt::many_core {
namespace {

double operations_per_us(const nlohmann::json& result) {
  EXPECT_EQ(result["status"], "ok") << result["message"];
  return result["operations_per_second"].get<double>() * 1e-6;
}

TEST(Simulator, one_core_pays_the_sum_of_its_hits) {
  // No work, no jitter in hits: exactly one fetch-and-add every 5 ns.
  EXPECT_DOUBLE_EQ(operations_per_us(run(primitive("faa", 1, 0))), 200);
  // A load, a plain store to the stack and a compare-and-swap, to the last one that fits.
  EXPECT_NEAR(operations_per_us(run(primitive("load-cas", 1, 0))), 1000.0 / 6.5, 0.01);
}

TEST(Simulator, fetch_and_add_follows_its_closed_form) {
  constexpr double transfer = 50, hit = 5, conflict = 10;
  for (const double work : {0.0, 100.0, 1000.0}) {
    for (const unsigned threads : {2U, 4U, 8U, 32U}) {
      const double free = threads / (work + transfer + hit) * 1000;
      // Of two, when one is served nobody else waits.
      const double period = 0.9 * transfer + (threads > 2 ? conflict : 0) + hit;
      const double bound = 1000 / period;
      // Where the two meet neither is exact.
      if (free > 0.5 * bound && free < 2 * bound) continue;
      EXPECT_NEAR(operations_per_us(run(primitive("faa", threads, work))) / std::min(free, bound),
                  1, 0.02)
          << threads << " threads, " << work << " ns of work";
    }
  }
}

TEST(Simulator, an_owner_makes_the_operations_that_fit_into_its_residence) {
  // At 0, 5, 10... of 6.5 to 19.5 ns: 3.1 on average; the line is free again when the last is done.
  Profile profile = simple_machine();
  profile.residence = 13;
  EXPECT_NEAR(operations_per_us(run(profile, primitive("faa", 8, 0))) / (3100 / (45.0 + 10 + 15.5)),
              1, 0.02);
  // With work in between there is one at a time, and the line is kept for nothing.
  EXPECT_NEAR(
      operations_per_us(run(profile, primitive("faa", 32, 100))) / (1000 / (45.0 + 10 + 13)), 1,
      0.02);
}

TEST(Simulator, compare_and_swap_loops_succeed_once_per_round) {
  // First come, first served: of all that have seen the same value one succeeds.
  constexpr double period = 0.9 * 50 + 10 + 5;
  for (const unsigned threads : {4U, 8U, 16U}) {
    EXPECT_NEAR(operations_per_us(run(primitive("cas", threads, 0))) * threads * period / 1000, 1,
                0.05)
        << threads << " threads";
  }
}

TEST(Simulator, compare_and_swap_loops_succeed_once_per_birthday_where_any_may_be_next) {
  // After a success all but one are to see a value for the first time. Whoever was just served is
  // on its way again and not drawn from, so that the draw after i failures is by one who knows the
  // value with probability (i - 1) / (n - 1); on average a success takes 1 + Q(n - 1) draws, with
  // Ramanujan's Q: about sqrt(pi n / 2) + 2/3.
  constexpr double period = 0.9 * 50 + 10 + 5;
  Profile profile = simple_machine();
  profile.turns = 0;
  for (const unsigned threads : {4U, 8U, 16U, 32U}) {
    double draws = 1, still_failing = 1;
    for (unsigned i = 1; i <= threads; ++i) {
      draws += still_failing;
      still_failing *= 1 - static_cast<double>(i) / (threads - 1);
      if (still_failing <= 0) break;
    }
    Point point = primitive("cas", threads, 0);
    point.measured_ns = 5e6;
    EXPECT_NEAR(operations_per_us(run(profile, point)) * draws * period / 1000, 1, 0.05)
        << threads << " threads";
  }
}

// Who has seen a value first must not be the first again for ever.
TEST(Simulator, cores_that_compete_alike_get_alike) {
  for (const double turns : {0, 1}) {
    for (const char* name : {"cas", "load-cas"}) {
      for (const unsigned threads : {16U, 32U}) {
        Profile profile = simple_machine();
        profile.turns = turns;
        Point point = primitive(name, threads, 0);
        point.measured_ns = 10e6;
        const nlohmann::json result = run(profile, point);
        ASSERT_EQ(result["status"], "ok") << result["message"];
        EXPECT_GT(result["fairness"].get<double>(), 0.5)
            << name << ", " << threads << " threads, turns " << turns;
      }
    }
  }
}

TEST(Simulator, private_lines_scale_perfectly) {
  EXPECT_NEAR(operations_per_us(run(primitive("private", 16, 45))) /
                  (16 * operations_per_us(run(primitive("private", 1, 45)))),
              1, 0.01);
}

TEST(Simulator, words_of_one_line_cost_as_much_as_one_word) {
  EXPECT_NEAR(operations_per_us(run(primitive("neighbours", 8, 0))) /
                  operations_per_us(run(primitive("faa", 8, 0))),
              1, 0.02);
}

TEST(Simulator, what_goes_in_comes_out) {
  for (const std::string name : {"lfree", "lock", "mutex", "vyukov-ring"}) {
    for (const contention::Scenario& scenario : contention::scenario_table) {
      const bool has_bulk = name == "lfree" || name == "mutex";
      if (scenario.needs_pop_wait() || (scenario.needs_bulk() && !has_bulk)) continue;
      const nlohmann::json result = run(queue(name, scenario.name, 6));
      EXPECT_EQ(result["status"], "ok")
          << name << ", " << scenario.name << ": " << result["message"];
      // A tree that has outgrown its queue is worked off without it.
      const bool tree = scenario.name == "fib" || scenario.name == "skynet";
      EXPECT_GT(result["pops"].get<double>(), tree                             ? 4
                                              : scenario.producer_pause_ns > 0 ? 50
                                                                               : 100)
          << name << ", " << scenario.name;
    }
  }
}

TEST(Simulator, order_is_that_of_all_operations) {
  for (const char* name : {"lock", "lfree"}) {
    const nlohmann::json order = run(queue(name, "rush", 8))["order"];
    EXPECT_EQ(order["rank_error_max"], 0) << name;
    EXPECT_GT(order["pushes_overtaken"], 0) << name << ": of pushes that overlap none was passed";
    EXPECT_LT(order["pushes_overtaken"], 0.9) << name;
    EXPECT_GT(order["operations"], 100) << name;
  }
  EXPECT_GT(run(queue("local", "rush", 8))["order"]["rank_error_mean"], 0);
  EXPECT_EQ(run(queue("lock", "ping-pong", 8))["order"], nullptr) << "there are two queues";
}

TEST(Simulator, sleepers_wake) {
  const nlohmann::json result = run(queue("lfree-waiting", "wake", 6));
  EXPECT_EQ(result["status"], "ok") << result["message"];
  EXPECT_GT(result["pops"].get<double>(), 10);
}

TEST(Simulator, the_same_seed_gives_the_same_bits) {
  for (const char* name : {"lfree", "mutex"}) {
    nlohmann::json first = run(queue(name, "pairs", 8), 7);
    nlohmann::json second = run(queue(name, "pairs", 8), 7);
    nlohmann::json other = run(queue(name, "pairs", 8), 8);
    for (nlohmann::json* each : {&first, &second, &other}) {
      each->erase("cpu_seconds");
      each->erase("memory_bytes");
    }
    EXPECT_EQ(first, second) << name;
    EXPECT_NE(first, other) << name;
  }
}

TEST(Simulator, more_threads_than_cores_share_them) {
  Point point = queue("mutex", "pairs", 48);
  point.measured_ns = 2e6;
  const nlohmann::json result = run(point);
  EXPECT_EQ(result["status"], "ok") << result["message"];
  EXPECT_GT(result["pops"].get<double>(), 100);
}

TEST(Simulator, false_sharing_is_told_from_sharing) {
  const nlohmann::json neighbours = run(primitive("neighbours", 8, 0), 1, true)["hot_lines"][0];
  EXPECT_GT(neighbours["false_sharing"].get<double>(), 0.9);
  const nlohmann::json one_word = run(primitive("faa", 8, 0), 1, true)["hot_lines"][0];
  EXPECT_LT(one_word["false_sharing"].get<double>(), 0.1);
  EXPECT_NE(one_word["sites"][0]["source"].get<std::string>().find("fetch_add"), std::string::npos);
}

TEST(Simulator, a_queue_that_never_answers_is_reported) {
  Point point = queue("mutex", "pairs", 4);
  point.subject = "stuck";
  point.module = IRT_STUCK;
  const nlohmann::json result = run(point);
  EXPECT_EQ(result["status"], "hung");
  EXPECT_NE(result["message"], "");
}

}  // namespace
}  // namespace irt::many_core
