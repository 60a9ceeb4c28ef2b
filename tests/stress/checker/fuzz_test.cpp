// The two systematic searches against each other on random programs: the same graphs, and none of
// them twice.

#include "tests/stress/checker/fuzz.hpp"

#include <array>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "stress/checker/checker.hpp"

namespace {

namespace checker = irt::checker;
using irt::fuzz::Step;
using Program = std::vector<std::vector<Step>>;

/// Who reads from whom, and the stores of each variable in modification order.
std::string fingerprint(const checker::Execution& execution) {
  const checker::Graph& graph = execution.graph();
  std::string text;
  for (unsigned t = 0; t < execution.threads(); ++t)
    for (const checker::EventId id : graph.thread(t).events) {
      const checker::Event& event = graph.event(id);
      text += event.reads
                  ? std::to_string(graph.event(event.from).ref()) + (event.writes ? "m" : "r")
                  : "-";
    }
  std::set<std::string> orders;  // locations are numbered by first use, which is no part of a graph
  for (std::uint32_t l = 0; l < graph.locations(); ++l) {
    std::string order = std::to_string(graph.location(l).address) + ":";
    for (const checker::EventId store : graph.location(l).stores)
      order += std::to_string(graph.event(store).ref()) + ",";
    orders.insert(order);
  }
  for (const std::string& order : orders) text += order;
  return text;
}

Program random_program(std::mt19937& random) {
  const auto below = [&random](unsigned n) { return static_cast<int>(random() % n); };
  static constexpr std::array load_orders{0, 2, 5};
  static constexpr std::array store_orders{0, 3, 5};
  static constexpr std::array fence_orders{2, 3, 4, 5};
  static constexpr std::array modify_orders{0, 2, 3, 4, 5};
  Program program(static_cast<std::size_t>(2 + below(2)));
  int value = 0;
  for (std::vector<Step>& thread : program) {
    const int steps = program.size() == 2 ? 2 + below(2) : 1 + below(2);
    for (int i = 0; i < steps; ++i) {
      const auto kind =
          static_cast<irt::fuzz::Kind>(std::array{0, 0, 1, 1, 2, 3, 4, 5}[random() % 8]);
      const int order = kind == irt::fuzz::load    ? load_orders[random() % 3]
                        : kind == irt::fuzz::store ? store_orders[random() % 3]
                        : kind == irt::fuzz::fence ? fence_orders[random() % 4]
                                                   : modify_orders[random() % 5];
      thread.push_back({kind, order, below(2), ++value});
    }
  }
  return program;
}

struct Explored {
  std::set<std::string> graphs;
  checker::Result result;
};

Explored explore(irt::virtual_cores::Module& module, const Program& program,
                 const checker::Options& base) {
  auto* run = module.function<void(const Step*, unsigned, unsigned)>("irt_fuzz_run");
  checker::Program checked;
  checked.module = &module;
  for (unsigned t = 0; t < program.size(); ++t)
    checked.threads.emplace_back([&program, run, t] {
      run(program[t].data(), static_cast<unsigned>(program[t].size()), t);
    });
  Explored explored;
  checker::Options options = base;
  options.each = [&](const checker::Execution& execution) {
    explored.graphs.insert(fingerprint(execution));
  };
  explored.result = checker::check(checked, options);
  return explored;
}

}  // namespace

TEST(Fuzz, searches_find_the_same_graphs_each_once) {
  irt::virtual_cores::Module module{IRT_FUZZ_PROBE};
  std::mt19937 random(20260101);
  unsigned compared = 0;
  for (unsigned i = 0; i < 250; ++i) {
    const Program program = random_program(random);
    const Explored all = explore(module, program, {});
    ASSERT_EQ(all.result.complete, all.graphs.size()) << "program " << i << ": a graph came twice";
    const Explored deep = explore(
        module, program, {.search = checker::Search::bounded, .budget = 99, .executions = 15'000});
    for (const std::string& graph : deep.graphs)
      ASSERT_TRUE(all.graphs.contains(graph)) << "program " << i << " misses " << graph;
    if (!deep.result.finished) continue;
    ++compared;
    ASSERT_EQ(all.graphs, deep.graphs) << "program " << i;
  }
  EXPECT_GT(compared, 150U);
}
