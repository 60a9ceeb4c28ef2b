#include "stress/scenarios/scenarios.hpp"

#include <deque>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

#include "stress/history/judge.hpp"

namespace irt::stress {
namespace {

/// A plain FIFO of bounded size.
class Plain final : public ElementQueue {
 public:
  explicit Plain(std::size_t capacity) : capacity_(capacity) {}
  bool push(unsigned /*worker*/, Element e) override {
    if (held_.size() == capacity_) return false;
    held_.push_back(e);
    return true;
  }
  bool pop(unsigned /*worker*/, Element& e) override {
    if (held_.empty()) return false;
    e = held_.front();
    held_.pop_front();
    return true;
  }

 private:
  std::size_t capacity_;
  std::deque<Element> held_;
};

/// One worker alone; the clock counts its steps.
class LoneCore final : public Core {
 public:
  using Core::Core;
  void idle() override { ++now_; }
  Stamp stamp() override { return ++now_; }
  Deadline now() override { return Deadline::clock::now(); }
  std::unique_ptr<ElementQueue> another_queue(unsigned /*workers*/, std::size_t capacity) override {
    return std::make_unique<Plain>(capacity);
  }

 protected:
  Stamp enter(Kind /*kind*/) override { return ++now_; }
  Stamp leave() override { return ++now_; }
  void wait_for_all() override { ++now_; }

 private:
  Stamp now_ = 0;
};

/// All for queues without optional methods.
std::vector<Scenario> all_scenarios() {
  std::vector<Scenario> all;
  for (const Scenario& scenario : scenarios())
    if (allows(Methods{}, Claims{}, scenario)) all.push_back(scenario);
  for (const Scenario& scenario : contention_scenarios())
    if (allows(Methods{}, Claims{}, scenario)) all.push_back(scenario);
  return all;
}

TEST(Scenarios, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const Scenario& s : contention_scenarios()) {
    EXPECT_TRUE(s.name.starts_with("contention/")) << s.name;
    EXPECT_TRUE(names.insert(s.name).second) << s.name;
    EXPECT_EQ(find_scenario(s.name), &s);
  }
  for (const Scenario& s : scenarios()) {
    EXPECT_TRUE(names.insert(s.name).second) << s.name;
    EXPECT_EQ(find_scenario(s.name), &s);
  }
  EXPECT_EQ(find_scenario("no-such-scenario"), nullptr);
}

TEST(Scenarios, KeepARightQueueRight) {
  for (const Scenario& scenario : all_scenarios()) {
    Plain queue(scenario.capacity);
    WorkerState state{
        .capacity = scenario.capacity, .random = SplitMix(42), .operations = 500, .log = {}};
    state.log.reserve(state.log_size(1));
    const auto* before = state.log.data();
    LoneCore core(state, queue);
    scenario.run(core);
    EXPECT_GT(state.log.size(), 20U) << scenario.name;
    EXPECT_EQ(state.log.data(), before) << scenario.name << ": recording must not allocate";
    History history{.logs = {state.log}, .drain = {}, .error = 0};
    Stamp now = 1'000'000;
    for (Element e = 0; queue.pop(0, e); now += 2)
      history.drain.push_back({now, now + 1, e, Kind::pop});
    const Claims claims{.ordering = Ordering::fifo_real_time, .bounded = true};
    const Verdict verdict = judge(history, claims, scenario.capacity);
    EXPECT_TRUE(verdict.violations.empty()) << scenario.name;
    EXPECT_GT(verdict.pushes, 0U) << scenario.name;
    EXPECT_GT(verdict.pops, 0U) << scenario.name;
  }
}

TEST(Roles, RespectsTheClaims) {
  for (const Callers producers : {Callers::one, Callers::many, Callers::own_worker}) {
    for (const Callers consumers : {Callers::one, Callers::many, Callers::own_worker}) {
      const Claims claims{.producers = producers, .consumers = consumers};
      for (const Scenario& scenario : all_scenarios()) {
        const Roles roles = roles_for(scenario, claims);
        unsigned pushers = 0;
        unsigned poppers = 0;
        bool all_do_both = true;
        for (unsigned w = 0; w < roles.workers; ++w) {
          pushers += roles.pushes(w) ? 1 : 0;
          poppers += roles.pops(w) ? 1 : 0;
          all_do_both = all_do_both && roles.pushes(w) && roles.pops(w);
          EXPECT_TRUE(roles.pushes(w) || roles.pops(w)) << scenario.name;
        }
        EXPECT_GE(pushers, 1U);
        EXPECT_GE(poppers, 1U);
        const bool own = producers == Callers::own_worker || consumers == Callers::own_worker;
        EXPECT_TRUE(all_do_both || !(own || scenario.together)) << scenario.name;
        EXPECT_TRUE(own || pushers == 1 || producers != Callers::one) << scenario.name;
        EXPECT_TRUE(own || poppers == 1 || consumers != Callers::one) << scenario.name;
      }
    }
  }
}

TEST(Roles, HasNoMoreWorkersThanTheQueueIsFor) {
  for (const Callers callers : {Callers::one, Callers::many, Callers::own_worker}) {
    for (unsigned most = 1; most <= 5; ++most) {
      const Claims claims{.producers = callers, .consumers = callers, .max_workers = most};
      for (const Scenario& scenario : all_scenarios()) {
        const Roles roles = roles_for(scenario, claims);
        EXPECT_LE(roles.workers, most) << scenario.name;
        EXPECT_GE(roles.producers, 1U) << scenario.name;
        EXPECT_GE(roles.consumers, 1U) << scenario.name;
      }
    }
  }
}

TEST(Elements, AreWordsThatTheQueueTakes) {
  const Claims claims{.all_ones_reserved = true, .reserved = {0, 3}, .unused_bits = 4};
  std::vector<Element> taken;
  for (std::uint64_t sequence = 0; taken.size() < 5; ++sequence)
    taken.push_back(next_element(claims, 0, sequence));
  EXPECT_EQ(taken, (std::vector<Element>{1, 2, 8, 9, 10}));
  EXPECT_FALSE(claims.allows(~Element{0}));
}

}  // namespace
}  // namespace irt::stress
