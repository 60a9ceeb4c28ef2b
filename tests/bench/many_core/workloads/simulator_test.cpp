/// What can be known of simulated runs without a machine: closed forms, conservation, determinism.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/many_core/coherence/arbitration.hpp"
#include "bench/many_core/sweeps/children.hpp"
#include "bench/many_core/sweeps/runs.hpp"
#include "bench/many_core/sweeps/sweep.hpp"
#include "bench/many_core/workloads/point.hpp"
#include "tests/bench/fields.hpp"

namespace irt::many_core {
namespace {

// Round figures, so that the sums below can be checked by hand.
Profile simple_machine() {
  return parse_profile(R"({
    "name": "simple", "summary": "one socket of 32 cores",
    "topology": {"sockets": 1, "nodes_per_socket": 1, "caches_per_node": 1, "cores_per_cache": 32,
                 "smt": 1, "cores": 32, "source": "made up"},
    "clock_ghz": [3, "made up"],
    "load_hit": [1, "made up"], "store_hit": [0.5, "made up"], "rmw_hit": [5, "made up"],
    "plain_op": [0.5, "made up"], "pause": [10, "made up"],
    "transfer": {"same_cache": [50, "made up"]},
    "shared_fetch": [0.8, "made up"], "dram": [100, "made up"],
    "overlap": [0.1, "made up"], "conflict": [10, "made up"], "read_occupancy": [10, "made up"],
    "invalidate_per_sharer": [3, "made up"]
  })",
                       "simple.json");
}

Point primitive(const std::string& name, unsigned threads, double work_ns) {
  return {.subject = name,
          .module = IRT_CONTENDED,
          .scenario = Scenario::primitive,
          .threads = threads,
          .work_ns = work_ns,
          .warm_up_ns = 100e3,
          .measured_ns = 500e3};
}

Point queue(const std::string& name, Scenario scenario, unsigned threads) {
  return {.subject = name,
          .module = std::string(IRT_CHECKED_QUEUES) + "/irt_checked_" + name + ".so",
          .scenario = scenario,
          .threads = threads,
          .producers = threads / 2,
          .work_ns = 85,
          .capacity = 64,
          .warm_up_ns = 50e3,
          .measured_ns = 200e3};
}

// In a process of its own, as every simulation.
nlohmann::json run(const Profile& profile, const Point& point, std::uint64_t seed = 1,
                   bool explain = false) {
  nlohmann::json result;
  const std::atomic<bool> never_interrupted{false};
  run_in_children(
      1, 1, 60, [&](std::size_t) { return simulate(profile, point, seed, explain).dump(); },
      [&](std::size_t, const ChildResult& child) {
        ASSERT_EQ(child.status, "ok") << child.message << child.text;
        result = nlohmann::json::parse(child.text);
      },
      never_interrupted);
  return result;
}

TEST(Runs, HaveTheFieldsOfTheirTool) {
  const Point point = queue("lock", Scenario::pairs, 2);
  const std::vector<nlohmann::json> seeds{run(simple_machine(), point)};
  nlohmann::ordered_json summed_up = summarise(simple_machine(), point, seeds);
  summed_up["conditions"] = nullptr;  // the sweep adds them
  EXPECT_EQ(keys_of(summed_up), fields_by(results::by_simulate));
}

nlohmann::json run(const Point& point, std::uint64_t seed = 1, bool explain = false) {
  return run(simple_machine(), point, seed, explain);
}

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

struct Shares {
  std::vector<unsigned> served;  ///< by core
  unsigned longest = 0;          ///< services between two of the same core
  unsigned same_socket = 0;      ///< services of the socket that was served before
};

// 64 cores, the first ones in socket 0, ask for a line again whenever they have had it.
Shares compete(bool in_turn, unsigned in_first_socket, unsigned services) {
  constexpr unsigned cores = 64;
  Waiting waiting(2, in_turn);
  Random random(1);
  const auto socket = [&](unsigned core) { return core < in_first_socket ? 0U : 1U; };
  std::vector<Request> requests(cores);
  Shares shares{std::vector<unsigned>(cores)};
  std::vector<unsigned> since(cores);
  for (unsigned core = 0; core < cores; ++core) {
    requests[core].core = core;
    waiting.add(requests[core], socket(core), 0);
  }
  unsigned last = 0;
  for (Time now = 0; now < services; ++now) {
    Request& request = waiting.take(now, socket(last), 2, random);
    for (unsigned& each : since) ++each;
    shares.longest = std::max(shares.longest, since[request.core]);
    since[request.core] = 0;
    ++shares.served[request.core];
    shares.same_socket += socket(request.core) == socket(last) ? 1 : 0;
    last = request.core;
    request.arrival = now;
    waiting.add(request, socket(request.core), now);
  }
  return shares;
}

TEST(Simulator, cores_of_two_sockets_get_alike) {
  const Shares shares = compete(true, 32, 64'000);
  // As often as each other, never more than two rounds apart, and most hand-overs are short.
  EXPECT_LE(std::ranges::max(shares.served) - std::ranges::min(shares.served), 1U);
  EXPECT_LT(shares.longest, 2 * 64U);
  EXPECT_GT(shares.same_socket, 64'000 * 6 / 10);
}

// Neither are the fewer cores of a socket left behind by the many of the other.
TEST(Simulator, cores_of_two_sockets_get_alike_where_any_may_be_next) {
  for (const unsigned in_first_socket : {32U, 48U}) {
    const Shares shares = compete(false, in_first_socket, 640'000);
    EXPECT_GT(std::ranges::min(shares.served), 9'500U) << in_first_socket;
    EXPECT_LT(std::ranges::max(shares.served), 10'500U) << in_first_socket;
    EXPECT_GT(shares.same_socket, 640'000 * 6 / 10) << in_first_socket;
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
  for (const char* name : {"lfree", "lock", "mutex", "vyukov-ring"}) {
    for (const Scenario scenario : {Scenario::pairs, Scenario::sides, Scenario::bursts}) {
      const nlohmann::json result = run(queue(name, scenario, 6));
      EXPECT_EQ(result["status"], "ok") << name << ": " << result["message"];
      EXPECT_GT(result["pops"].get<double>(), 100) << name;
    }
  }
}

TEST(Simulator, the_same_seed_gives_the_same_bits) {
  for (const char* name : {"lfree", "mutex"}) {
    nlohmann::json first = run(queue(name, Scenario::pairs, 8), 7);
    nlohmann::json second = run(queue(name, Scenario::pairs, 8), 7);
    nlohmann::json other = run(queue(name, Scenario::pairs, 8), 8);
    for (nlohmann::json* each : {&first, &second, &other}) {
      each->erase("cpu_seconds");
      each->erase("memory_bytes");
    }
    EXPECT_EQ(first, second) << name;
    EXPECT_NE(first, other) << name;
  }
}

TEST(Simulator, more_threads_than_cores_share_them) {
  Point point = queue("mutex", Scenario::pairs, 48);
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
  Point point = queue("mutex", Scenario::pairs, 4);
  point.subject = "stuck";
  point.module = IRT_STUCK;
  const nlohmann::json result = run(point);
  EXPECT_EQ(result["status"], "hung");
  EXPECT_NE(result["message"], "");
}

TEST(Simulator, a_crash_takes_nothing_with_it) {
  std::map<std::size_t, std::string> ended;
  const std::atomic<bool> never_interrupted{false};
  run_in_children(
      3, 2, 0.5,
      [](std::size_t i) -> std::string {
        if (i == 0) std::abort();
        if (i == 1) {
          for (;;) pause();
        }
        return "done";
      },
      [&](std::size_t i, const ChildResult& child) { ended[i] = child.status; }, never_interrupted);
  const std::map<std::size_t, std::string> expected{{0, "crashed"}, {1, "hung"}, {2, "ok"}};
  EXPECT_EQ(ended, expected);
}

TEST(Simulator, levels_are_where_threads_first_leave_a_group) {
  const auto of = [](const char* machine, Placement placement) {
    std::string text;
    for (const Level& level : levels(load_profile(machine), placement))
      text += std::to_string(level.threads) + ' ' + std::string(level.name) + "; ";
    return text;
  };
  EXPECT_EQ(of("granite-rapids-96", Placement::close),
            "32 one node; 96 a core each; 192 all hardware threads; ");
  EXPECT_EQ(of("epyc-milan-2x64", Placement::close),
            "8 one cache; 64 one socket; 128 a core each; 256 all hardware threads; ");
  EXPECT_EQ(of("xeon-6132", Placement::siblings), "14 one socket; 28 all hardware threads; ");
  EXPECT_EQ(of("xeon-7400", Placement::spread), "24 all hardware threads; ");
}

TEST(Simulator, counts_of_cores_are_ranges_or_lists) {
  EXPECT_EQ(parse_cores("1..12"), (std::vector<unsigned>{1, 2, 3, 4, 6, 8, 12}));
  EXPECT_EQ(parse_cores("24,6"), (std::vector<unsigned>{6, 24}));
  for (const char* absurd :
       {"", "0", "-3", "1..", "8..4", "100000", "many", "1,,2", "1..99999999999"})
    EXPECT_THROW(parse_cores(absurd), UsageError) << absurd;
}

TEST(Simulator, unknown_names_are_answered_with_the_nearest) {
  try {
    parse_scenario("pair");
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("pairs"), std::string::npos);
  }
}

}  // namespace
}  // namespace irt::many_core
