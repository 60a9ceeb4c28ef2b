// The memory model against the standard: for each program exactly the outcomes that C++20 allows,
// without load buffering. The programs are in litmus_probe.cpp.

#include "tests/stress/checker/litmus.hpp"

#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>

#include "stress/checker/checker.hpp"

namespace {

namespace checker = irt::checker;
using Outcomes = std::set<std::string>;

struct Explored {
  Outcomes outcomes;
  checker::Result result;
};

class Litmus : public testing::Test {
 protected:
  Explored explore(const irt::litmus::Program& program, const checker::Options& base) {
    const auto* results = module_.function<const int*()>("irt_litmus_results")();
    const auto final_value = module_.function<int(unsigned)>("irt_litmus_final");
    checker::Program checked;
    checked.module = &module_;
    for (const auto thread : program.threads)
      if (thread != nullptr) checked.threads.emplace_back(thread);
    std::string finals;
    checked.finish = [&] {
      finals.clear();
      for (unsigned v = 0; v < program.finals; ++v) finals += char('0' + final_value(v));
    };
    Explored explored;
    checker::Options options = base;
    options.each = [&](const checker::Execution&) {
      std::string outcome;
      for (unsigned i = 0; i < program.results; ++i) outcome += char('0' + results[i]);
      explored.outcomes.insert(program.finals == 0 ? outcome : outcome + "/" + finals);
    };
    explored.result = checker::check(checked, options);
    if (explored.result.finding)
      explored.outcomes.insert(std::string(name_of(explored.result.finding->kind)));
    return explored;
  }

  [[nodiscard]] std::map<std::string, const irt::litmus::Program*> programs() const {
    const auto programs_of =
        module_.function<const irt::litmus::Program*(unsigned, unsigned*)>("irt_litmus_programs");
    std::map<std::string, const irt::litmus::Program*> result;
    unsigned count = 0;
    for (unsigned part = 0; const auto* first = programs_of(part, &count); ++part)
      for (unsigned i = 0; i < count; ++i) result[first[i].name] = &first[i];
    return result;
  }

  irt::virtual_cores::Module module_{IRT_LITMUS_PROBE};
};

}  // namespace

namespace {

/// By the program's name; results, then last values after a '/'.
const std::map<std::string, std::string>& expected() {
  static const std::map<std::string, std::string> table{
      {"2+2W+rlx", "/11 /12 /21 /22"},
      {"2+2W+sc", "/12 /21 /22"},
      {"2+2W+sc+fences", "/12 /21 /22"},
      {"CAS+chain", "000/1 001/1 010/2 011/2 012/3"},
      {"CAS+stale+failure", "00 01 02 10 11 12"},
      {"CAS+two", "01/1 20/2"},
      {"CoRR", "00 01 02 11 12 22"},
      {"CoRW", "01 02 21 22"},
      {"CoWR", "11 12 22"},
      {"CoWW", "0 1 2"},
      {"IRIW+rel+acq",
       "0000 0001 0010 0011 0100 0101 0110 0111 1000 1001 1010 1011 1100 1101 1110 1111"},  // readers
                                                                                            // may
                                                                                            // disagree
      {"IRIW+sc",
       "0000 0001 0010 0011 0100 0101 0110 0111 1000 1001 1011 1100 1101 1110 1111"},  // 1010 is
                                                                                       // what S
                                                                                       // forbids
      {"IRIW+sc+fences",
       "0000 0001 0010 0011 0100 0101 0110 0111 1000 1001 1011 1100 1101 1110 1111"},
      {"ISA2", "000 001 100 101 111"},
      {"LB+acq+rel", "00 01 10"},
      {"LB+rlx", "00 01 10"},  // 11 would be load buffering
      {"MP+data", "00 11"},
      {"MP+data+race", "data race"},
      {"MP+fence+acq", "00 01 11"},
      {"MP+fence+misplaced", "00 01 10 11"},
      {"MP+fences", "00 01 11"},
      {"MP+fences+data", "00 11"},
      {"MP+rel+acq", "00 01 11"},
      {"MP+rel+fence", "00 01 11"},
      {"MP+rel+rlx", "00 01 10 11"},
      {"MP+rlx", "00 01 10 11"},
      {"MP+sc+store+rlx", "00 01 10 11"},
      {"OOTA", "00"},
      {"OOTA+if", "00"},
      {"R+rlx", "0/11 0/12 1/11 1/12"},
      {"R+sc", "0/11 1/11 1/12"},  // 0/12 needs a cycle in S
      {"R+sc+fences", "0/11 1/11 1/12"},
      {"RMW+store", "0/5 5/6"},
      {"RMW+three", "012/3 021/3 102/3 120/3 201/3 210/3"},
      {"RMW+two", "01/2 10/2"},
      {"RS+modify", "000 010 100 110 121"},
      {"RS+other+store", "00 01 11 20 21"},  // 10 needs 1, which synchronizes
      {"RS+own+store", "data race"},         // C++17 had the own store continue the sequence
      {"RS+two",
       "0100 0110 0120 0140 0400 0410 0440 0450 1000 1010 1020 1040 4000 4010 4040 4050 4500 4540 "
       "4550 4561 5400 5440 5450 5461"},
      {"RWC+sc+fences", "000 001 010 011 101 110 111"},
      {"S+rel+acq", "0/1 0/2 1/1"},
      {"SB+acq_rel+fences", "00 01 10 11"},
      {"SB+modify", "01 10 11"},  // a modification reads the newest
      {"SB+rel+acq", "00 01 10 11"},
      {"SB+rlx", "00 01 10 11"},
      {"SB+rmw+same", "01 10 11"},
      {"SB+sc", "01 10 11"},
      {"SB+sc+fence+access", "01 10 11"},
      {"SB+sc+fences", "01 10 11"},
      {"SB+sc+modify", "00 01 10 11"},
      {"SB+sc+one+fence", "00 01 10 11"},
      {"SB+sc+rlx+load", "00 01 10 11"},         // a relaxed load is no part of S
      {"W+RWC", "000 001 010 011 101 110 111"},  // 100 would order the fences both ways
      {"WRC+rel+acq", "000 001 010 011 100 101 111"},
      {"WRC+rlx", "000 001 010 011 100 101 110 111"},
      {"WRC+sc+fences", "000 001 010 011 100 101 111"},
      {"Z6.U",
       "010 011 030 031 120 121 130 131 310 311 340 341"},  // 130 is what C++20 allows again:
                                                            // release to seq_cst is no part of S
  };
  return table;
}

std::string joined(const Outcomes& outcomes) {
  std::string text;
  for (const std::string& outcome : outcomes) text += (text.empty() ? "" : " ") + outcome;
  return text;
}

}  // namespace

TEST_F(Litmus, every_program_has_exactly_the_outcomes_of_the_standard) {
  for (const auto& [name, program] : programs()) {
    if (name == "CoRR2") continue;
    const Explored explored = explore(*program, {});
    ASSERT_TRUE(expected().contains(name)) << name;
    EXPECT_EQ(joined(explored.outcomes), expected().at(name)) << name;
    EXPECT_EQ(explored.result.cut, 0U) << name << ": a graph was begun that is not consistent";
  }
  EXPECT_EQ(programs().size(), expected().size() + 1);
}

TEST_F(Litmus, two_readers_agree_on_the_order_of_two_stores) {
  const Explored explored = explore(*programs().at("CoRR2"), {});
  // Each reader sees one of 00 01 02 11 12 21 22; all pairs but the two that disagree.
  EXPECT_EQ(explored.outcomes.size(), 7U * 7U - 2U);
  EXPECT_FALSE(explored.outcomes.contains("1221"));
  EXPECT_FALSE(explored.outcomes.contains("2112"));
}

TEST_F(Litmus, a_search_without_reduction_agrees) {
  for (const auto& [name, program] : programs()) {
    const Explored deep =
        explore(*program, {.search = checker::Search::bounded, .budget = 99, .executions = 25'000});
    const Explored all = explore(*program, {});
    if (deep.result.finished || deep.result.finding) {
      EXPECT_EQ(deep.outcomes, all.outcomes) << name;
    }
    for (const std::string& outcome : deep.outcomes)
      EXPECT_TRUE(all.outcomes.contains(outcome)) << name << ": " << outcome;
  }
}

TEST_F(Litmus, random_searches_stay_within_the_model_and_reach_most_of_it) {
  for (const auto search : {checker::Search::random, checker::Search::pct, checker::Search::pos}) {
    std::size_t reached = 0;
    std::size_t possible = 0;
    for (const auto& [name, program] : programs()) {
      const Explored some = explore(*program, {.search = search, .executions = 2000});
      const Explored all = explore(*program, {});
      if (all.result.finding) {
        EXPECT_TRUE(some.result.finding) << name;
        continue;
      }
      for (const std::string& outcome : some.outcomes)
        EXPECT_TRUE(all.outcomes.contains(outcome)) << name << ": " << outcome;
      reached += some.outcomes.size();
      possible += all.outcomes.size();
    }
    EXPECT_GT(reached * 10, possible * 9);
  }
}
