// How fast the real-time oracle is, in processor time. The target is 10^7 operations a second on
// one core; the test fails only far below it, because test machines are shared.
#include <ctime>
#include <gtest/gtest.h>
#include <random>

#include "stress/history/real_time.hpp"

namespace irt::stress {
namespace {

/// Four producers and four consumers of a correct queue, `each` operations per worker.
History large_history(std::uint64_t each) {
  constexpr unsigned producers = 4;
  History h;
  h.logs.resize(2 * producers);
  for (auto& log : h.logs) log.reserve(each);
  std::mt19937 random(1);
  Stamp now = 1'000;
  for (std::uint64_t i = 0; i < each; ++i) {
    for (unsigned p = 0; p < producers; ++p, now += 10) {
      h.logs[p].push_back({now, now + 30 + random() % 8, element(p, i), Kind::push});
      h.logs[producers + p].push_back(
          {now + 35, now + 60 + random() % 8, element(p, i), Kind::pop});
    }
  }
  return h;
}

TEST(Speed, TheRealTimeOracleJudgesMillionsOfOperationsASecond) {
  const History h = large_history(250'000);
  const std::clock_t start = std::clock();
  const Matching matching(h);
  EXPECT_TRUE(matching.violations().empty());
  EXPECT_TRUE(
      judge_real_time(matching, Specification({.ordering = Ordering::fifo_real_time}, 0)).empty());
  const double passed = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const double rate = 8 * 250'000 / passed;
  std::printf("real-time oracle: %.1f million operations a second\n", rate / 1e6);
  EXPECT_GT(rate, 1e6);
}

}  // namespace
}  // namespace irt::stress
