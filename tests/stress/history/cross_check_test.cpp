// The sweeps against brute force, on random small histories.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

#include "brute_force.hpp"
#include "stress/history/happens_before.hpp"
#include "stress/history/real_time.hpp"
#include "tests/stress/history/random.hpp"

namespace irt::stress {
namespace {

/// A FIFO's answers at random moments, stretched to random intervals; half of the time then bent:
/// answers exchanged or moved in time. `workers` share the operations.
History random_history(Random& random, unsigned workers, unsigned operations) {
  History h;
  h.logs.resize(workers);
  std::vector<Element> queue;
  std::vector<std::uint64_t> pushed(workers, 0);
  const Stamp stretch = std::uint64_t{2} << (2 * below(random, 3));  // little, some, much overlap
  std::vector<Stamp> free_from(workers, 0);
  Stamp now = 0;
  for (unsigned i = 0; i < operations; ++i) {
    now += 1 + below(random, 4);
    const auto worker = static_cast<unsigned>(below(random, workers));
    Operation operation;
    operation.invoked = std::max(free_from[worker], now - std::min(now, below(random, stretch)));
    operation.returned = std::max(operation.invoked + 1, now + below(random, stretch));
    free_from[worker] = operation.returned + 1;
    if (below(random, 2) == 0) {
      operation.kind = Kind::push;
      operation.value = element(worker, pushed[worker]++);
      queue.push_back(operation.value);
    } else if (queue.empty()) {
      operation.kind = Kind::empty;
    } else {
      operation.kind = Kind::pop;
      operation.value = queue.front();
      queue.erase(queue.begin());
    }
    h.logs[worker].push_back(operation);
  }
  if (below(random, 2) == 0) {
    std::vector<Operation*> answers;
    for (auto& log : h.logs) {
      for (Operation& operation : log) {
        if (operation.kind != Kind::push) answers.push_back(&operation);
      }
    }
    if (answers.size() >= 2) {
      Operation& one = *answers[below(random, answers.size())];
      Operation& other = *answers[below(random, answers.size())];
      std::swap(one.value, other.value);
      std::swap(one.kind, other.kind);
    }
  }
  return h;
}

std::vector<Operation> flat(const History& h) {
  std::vector<Operation> all;
  for (const auto& log : h.logs) all.insert(all.end(), log.begin(), log.end());
  return all;
}

std::string print(const History& h) {
  std::ostringstream text;
  for (std::size_t worker = 0; worker < h.logs.size(); ++worker) {
    for (const Operation& o : h.logs[worker]) {
      text << "worker " << worker << " kind " << static_cast<int>(o.kind) << ' '
           << element_name(o.value) << " [" << o.invoked << ", " << o.returned << "]\n";
    }
  }
  return text.str();
}

bool real_time_accuses(const Matching& matching) {
  static const Specification fifo({.ordering = Ordering::fifo_real_time}, 0);
  return !judge_real_time(matching, fifo).empty() ||
         std::ranges::any_of(matching.violations(),
                             [](const Violation& v) { return v.pattern != Pattern::lost; });
}

TEST(CrossCheck, RealTimeAgreesWithBruteForceOn100000Histories) {
  Random random(2024);
  int accepted = 0;
  constexpr int histories = 100'000;
  for (int i = 0; i < histories; ++i) {
    const auto workers = static_cast<unsigned>(2 + below(random, 4));
    const History h = random_history(random, workers, static_cast<unsigned>(3 + below(random, 7)));
    const std::vector<Operation> operations = flat(h);
    const bool expected = linearizable(operations, [&](std::size_t a, std::size_t b) {
      return operations[a].returned < operations[b].invoked;
    });
    ASSERT_EQ(!real_time_accuses(Matching(h)), expected) << print(h);
    accepted += expected ? 1 : 0;
  }
  EXPECT_GT(accepted, histories / 4) << "the histories must not be trivially wrong";
  EXPECT_LT(accepted, histories * 9 / 10) << "nor trivially right";
}

/// The closure of program order and push -> pop.
std::vector<std::vector<bool>> happens_before(const History& h) {
  const std::vector<Operation> operations = flat(h);
  std::vector<std::vector<bool>> before(operations.size(),
                                        std::vector<bool>(operations.size(), false));
  std::size_t start = 0;
  for (const auto& log : h.logs) {
    for (std::size_t i = start; i + 1 < start + log.size(); ++i) before[i][i + 1] = true;
    start += log.size();
  }
  for (std::size_t i = 0; i < operations.size(); ++i) {
    for (std::size_t j = 0; j < operations.size(); ++j) {
      if (operations[i].kind == Kind::push && operations[j].kind == Kind::pop &&
          operations[i].value == operations[j].value) {
        before[i][j] = true;
      }
    }
  }
  for (std::size_t k = 0; k < operations.size(); ++k) {
    for (std::size_t i = 0; i < operations.size(); ++i) {
      for (std::size_t j = 0; before[i][k] && j < operations.size(); ++j) {
        if (before[k][j]) before[i][j] = true;
      }
    }
  }
  return before;
}

TEST(CrossCheck, HappensBeforeNeverAccusesWhatBruteForceAccepts) {
  Random random(7);
  int wrong = 0;
  int caught = 0;
  for (int i = 0; i < 50'000; ++i) {
    const History h = random_history(random, 3, static_cast<unsigned>(3 + below(random, 6)));
    const Matching matching(h);
    const bool once = std::ranges::none_of(
        matching.violations(), [](const Violation& v) { return v.pattern != Pattern::lost; });
    const HappensBefore order(matching);
    const Specification fifo({.ordering = Ordering::fifo_happens_before}, 0);
    const bool accused = !once || order.cycle().has_value() ||
                         order.judge_order(false).has_value() ||
                         order.judge_empties(fifo).first.has_value();
    const auto before = happens_before(h);
    const bool right =
        linearizable(flat(h), [&](std::size_t a, std::size_t b) -> bool { return before[a][b]; });
    ASSERT_FALSE(right && accused) << print(h);
    wrong += right ? 0 : 1;
    caught += accused ? 1 : 0;
  }
  EXPECT_GT(wrong, 1'000);
  EXPECT_GT(caught, wrong * 3 / 4) << "the oracle is sound by design; it must also have teeth";
  RecordProperty("wrong", wrong);
  RecordProperty("caught", caught);
  std::printf("happens-before: %d of %d wrong histories caught\n", caught, wrong);
}

}  // namespace
}  // namespace irt::stress
