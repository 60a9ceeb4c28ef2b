/// Random programs of equal threads, and the search that exchanges them against the one that does
/// not.
#pragma once

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "stress/checker/checker.hpp"
#include "tests/stress/checker/twins.hpp"

namespace irt::twins {

struct Program {
  std::vector<std::vector<Step>> threads;
  std::vector<unsigned> roles;
  int forbidden = -1;       ///< what no thread may have read last
  bool first_slot = false;  ///< whether the slot of thread 0 is looked at in the end
};

/// All ways to give the threads of each role each other's names.
inline std::vector<std::vector<unsigned>> orders_of(const std::vector<unsigned>& roles) {
  std::vector<unsigned> names(roles.size());
  std::iota(names.begin(), names.end(), 0U);
  std::vector<std::vector<unsigned>> orders;
  do {
    bool fits = true;
    for (std::size_t i = 0; i < names.size(); ++i) fits = fits && roles[names[i]] == roles[i];
    if (fits) orders.push_back(names);
  } while (std::ranges::next_permutation(names).found);
  return orders;
}

/// Whether `event` is a round of a loop that was for nothing: another one reads at the same place.
/// How many such rounds there are is no part of what is explored.
inline bool is_idle(const checker::Graph& graph, const checker::Event& event) {
  const std::vector<checker::EventId>& events = graph.thread(event.thread).events;
  if (event.kind != checker::EventKind::load || event.index >= events.size()) return false;
  const checker::Event& next = graph.event(events[event.index]);
  return next.pc == event.pc && next.location == event.location;
}

/// Who reads from whom, and the stores of each location in modification order, when thread t is
/// called `names[t]`. Locations have no names, for slots and blocks are exchanged with threads.
inline std::string fingerprint(const checker::Execution& execution,
                               const std::vector<unsigned>& names) {
  const checker::Graph& graph = execution.graph();
  const auto name = [&](const checker::Event& event) {
    if (event.kind == checker::EventKind::initial) return std::string("i");
    unsigned index = event.index;
    for (unsigned i = 0; i + 1 < event.index; ++i)
      index -= is_idle(graph, graph.event(graph.thread(event.thread).events[i])) ? 1 : 0;
    return std::to_string(names[event.thread]) + "." + std::to_string(index);
  };
  std::vector<std::string> threads(execution.threads());
  for (unsigned t = 0; t < execution.threads(); ++t)
    for (const checker::EventId id : graph.thread(t).events) {
      const checker::Event& event = graph.event(id);
      if (is_idle(graph, event)) continue;
      threads[names[t]] += std::to_string(static_cast<int>(event.kind));
      if (event.reads) threads[names[t]] += "(" + name(graph.event(event.from)) + ")";
    }
  std::multiset<std::string> orders;
  for (std::uint32_t l = 0; l < graph.locations(); ++l) {
    std::string order;
    for (const checker::EventId store : graph.location(l).stores)
      order += name(graph.event(store)) + ",";
    orders.insert(order);
  }
  std::string text;
  for (const std::string& thread : threads) text += thread + "|";
  for (const std::string& order : orders) text += order + ";";
  return text;
}

inline Step random_step(std::mt19937& random, bool odd) {
  const auto below = [&random](unsigned n) { return static_cast<int>(random() % n); };
  static constexpr std::array even{load,        load,       store,     store,   exchange,
                                   add,         fence,      compare,   compare, store_number,
                                   swap_number, slot_store, slot_load, publish, follow,
                                   locked_add,  await};
  static constexpr std::array uneven{odd_one, odd_slot, scan, last_one_stops};
  static constexpr std::array load_orders{0, 2, 5};
  static constexpr std::array store_orders{0, 3, 5};
  static constexpr std::array fence_orders{2, 3, 4, 5};
  static constexpr std::array modify_orders{0, 2, 3, 4, 5};
  const Kind kind = odd ? uneven[random() % uneven.size()] : even[random() % even.size()];
  int order = 0;
  switch (kind) {
    case load:
    case slot_load:
    case await:
    case scan:
      order = load_orders[random() % load_orders.size()];
      break;
    case store:
    case store_number:
    case slot_store:
    case odd_one:
    case odd_slot:
      order = store_orders[random() % store_orders.size()];
      break;
    case fence:
      order = fence_orders[random() % fence_orders.size()];
      break;
    default:
      order = modify_orders[random() % modify_orders.size()];
  }
  // Other than threads' numbers plus one, so that these can be exchanged.
  const int value = 11 + below(3);
  return {kind, order, below(2), value, below(3), below(2) == 0 ? below(4) : 11 + below(3)};
}

/// Two or three equal threads, and at most one other one. One in `odd` of their steps is not the
/// same for all; 0: none is.
inline Program random_program(std::mt19937& random, unsigned odd) {
  const auto below = [&random](unsigned n) { return static_cast<unsigned>(random() % n); };
  const auto steps = [&](unsigned count) {
    std::vector<Step> result;
    while (result.size() < count)
      result.push_back(random_step(random, odd != 0 && random() % odd == 0));
    return result;
  };
  Program program;
  const unsigned equal = 2 + below(2);
  const std::vector<Step> twin = steps(below(3) + (equal == 2 ? 2 : 1));
  program.threads.assign(equal, twin);
  program.roles.assign(equal, 0);
  if (random() % 2 == 0) {
    const auto at = static_cast<std::ptrdiff_t>(random() % (equal + 1));
    program.threads.insert(program.threads.begin() + at, steps(1 + below(2)));
    program.roles.insert(program.roles.begin() + at, 1);
  }
  program.forbidden = -1;
  if (below(4) == 0)
    program.forbidden = static_cast<int>(below(2) == 0 ? 1 + below(3) : 11 + below(30));
  program.first_slot = random() % 8 == 0;
  return program;
}

struct Tally {
  unsigned compared = 0;   ///< graph by graph
  unsigned refused = 0;    ///< threads that are not equal
  unsigned found = 0;      ///< programs with a finding
  std::uint64_t all = 0;   ///< executions of the programs compared
  std::uint64_t some = 0;  ///< of the search that exchanges threads
};

inline std::string name(const Program& program) {
  std::string text;
  for (std::size_t t = 0; t < program.threads.size(); ++t)
    for (const Step& s : program.threads[t]) {
      for (const int part : {int{s.kind}, s.order, s.variable, s.value, s.thread, s.seen})
        text += std::to_string(part) + " ";
      text += &s == &program.threads[t].back() ? "|\n" : "|";
    }
  return text + "forbidden " + std::to_string(program.forbidden);
}

class TwinPrograms : public testing::Test {
 protected:
  struct Explored {
    std::set<std::string> orbits;  ///< of graphs, each by its first name
    checker::Result result;
  };

  Explored explore(const Program& program, bool symmetry) {
    auto* run = module_.function<void(const Step*, unsigned, int, int)>("irt_twins_run");
    auto* end = module_.function<int(bool)>("irt_twins_end");
    checker::Program checked;
    checked.module = &module_;
    checked.roles = program.roles;
    for (unsigned t = 0; t < program.threads.size(); ++t)
      checked.threads.emplace_back([&program, run, t] {
        const auto first = std::ranges::find(program.roles, program.roles[t]);
        const std::vector<Step>& steps =  // at one place for all of a role
            program.threads[static_cast<std::size_t>(first - program.roles.begin())];
        run(steps.data(), static_cast<unsigned>(steps.size()), static_cast<int>(t),
            program.forbidden);
      });
    checked.finish = [&program, end] { end(program.first_slot); };
    const std::vector<std::vector<unsigned>> orders = orders_of(program.roles);
    Explored explored;
    checker::Options options;
    options.symmetry = symmetry;
    options.executions = symmetry ? 100'000 : 20'000;
    options.limits.leaks = false;
    options.each = [&](const checker::Execution& execution) {
      std::string first = fingerprint(execution, orders.front());
      for (const std::vector<unsigned>& names : orders)
        first = std::min(first, fingerprint(execution, names));
      explored.orbits.insert(first);
    };
    explored.result = checker::check(checked, options);
    return explored;
  }

  /// Both searches on one program. What one finds the other must find; else, unless threads turn
  /// out to differ, they have the same graphs.
  void compare(const Program& program, Tally& tally) {
    const Explored all = explore(program, false);
    if (!all.result.finished && !all.result.finding) return;
    const Explored some = explore(program, true);
    ASSERT_EQ(all.result.finding.has_value(), some.result.finding.has_value()) << name(program);
    if (all.result.finding) {
      ++tally.found;
      return;
    }
    ASSERT_TRUE(some.result.finished) << some.result.incomplete << name(program);
    if (!some.result.uneven.empty()) {
      ++tally.refused;
      return;
    }
    ASSERT_EQ(all.orbits, some.orbits) << name(program);
    ++tally.compared;
    tally.all += all.result.executions;
    tally.some += some.result.executions;
  }

  /// So many random programs.
  Tally compare_random(unsigned programs, unsigned odd, unsigned seed) {
    std::mt19937 random(seed);
    Tally tally;
    for (unsigned i = 0; i < programs && !HasFatalFailure(); ++i)
      compare(random_program(random, odd), tally);
    return tally;
  }

  irt::virtual_cores::Module module_{IRT_SYMMETRY_PROBE};
};

}  // namespace irt::twins
