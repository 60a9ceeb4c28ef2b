#include "bench/many_core/sweeps/sweep.hpp"

#include <gtest/gtest.h>
#include <map>
#include <unistd.h>
#include <vector>

#include "bench/many_core/sweeps/runs.hpp"
#include "tests/bench/fields.hpp"
#include "tests/bench/many_core/simulated_run.hpp"

namespace irt::many_core {
namespace {

TEST(Runs, HaveTheFieldsOfTheirTool) {
  const Point point = queue("lock", "pairs", 2);
  const std::vector<nlohmann::json> seeds{run(simple_machine(), point)};
  nlohmann::ordered_json summed_up = summarise(simple_machine(), point, seeds);
  summed_up["conditions"] = nullptr;  // the sweep adds them
  EXPECT_EQ(keys_of(summed_up), fields_by(results::by_simulate));
}

TEST(Sweep, a_crash_takes_nothing_with_it) {
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

TEST(Sweep, counts_of_cores_are_ranges_or_lists) {
  EXPECT_EQ(parse_cores("1..12"), (std::vector<unsigned>{1, 2, 3, 4, 6, 8, 12}));
  EXPECT_EQ(parse_cores("24,6"), (std::vector<unsigned>{6, 24}));
  for (const char* absurd :
       {"", "0", "-3", "1..", "8..4", "100000", "many", "1,,2", "1..99999999999"})
    EXPECT_THROW(parse_cores(absurd), UsageError) << absurd;
}

TEST(Sweep, unknown_names_are_answered_with_the_nearest) {
  try {
    parse_scenario("pair");
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("pairs"), std::string::npos);
  }
}

}  // namespace
}  // namespace irt::many_core
