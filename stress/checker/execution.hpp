/// One execution of a program after another, with what each has shown.
///
/// Its parts (events.hpp) each know one thing: the strategy's choices become the *turns* of threads
/// and what their *accesses* read; *loops* that wait are told from such as work; a *watch* is kept
/// on memory; the *kernel* has locks and futexes; the *conclusion* says how it ends.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stress/checker/events.hpp"

namespace irt::checker {

class Execution {
 public:
  Execution(const Program& program, const Limits& limits) : events_(program, limits) {}

  Outcome run(Strategy& strategy);
  /// The execution in progress; null outside of `run`.
  static Execution* current_execution() { return running; }

  // Before.
  /// Memory orders of the code in executions to come.
  [[nodiscard]] MemoryOrders& orders() { return parts_.accesses.orders(); }
  /// Stops `thread` for good before event number `events` (from 0) of its own, from now on.
  void freeze(unsigned thread, std::size_t events) { parts_.turns.freeze(thread, events); }
  [[nodiscard]] bool freezes() const { return parts_.turns.frozen().has_value(); }

  // While it is in progress, for the program's functions, and afterwards.
  [[nodiscard]] Conclusion& conclusion() { return parts_.state.conclusion; }
  [[nodiscard]] const Conclusion& conclusion() const { return parts_.state.conclusion; }
  [[nodiscard]] Kernel& kernel() { return parts_.kernel; }
  [[nodiscard]] const Allocations& allocations() const { return parts_.allocations; }
  [[nodiscard]] ExecutionState& state() { return parts_.state; }
  [[nodiscard]] const ExecutionState& state() const { return parts_.state; }
  [[nodiscard]] const Graph& graph() const { return parts_.state.graph; }
  [[nodiscard]] const Heap& heap() const { return parts_.state.heap; }
  [[nodiscard]] const std::vector<Step>& steps() const { return parts_.state.steps; }
  /// From 0 on; the one that prepares and finishes has this number.
  [[nodiscard]] unsigned threads() const { return parts_.state.threads; }
  /// Those that were born: of a program that begins threads itself, in this order.
  [[nodiscard]] const std::vector<unsigned>& born() const { return parts_.process.born(); }
  /// The steps with threads numbered as they were born: what another process that repeats them
  /// numbers them by.
  [[nodiscard]] std::vector<Step> steps_as_born() const;
  /// The past of `thread`, as a judge may need it between operations.
  [[nodiscard]] const Clock& clock_of(unsigned thread) const { return graph().thread(thread).now; }
  /// The thread that was stopped for good, if it came that far.
  [[nodiscard]] std::optional<unsigned> stopped() const;
  [[nodiscard]] const std::optional<Finding>& finding() const { return conclusion().finding(); }
  /// Whether `thread` came to its end, or was stopped for good.
  [[nodiscard]] bool ended(unsigned thread) const { return parts_.turns.of(thread).done; }
  /// Where a thread waits that did not come to its end; null if it did, or if it was on its way.
  [[nodiscard]] const Turns::Thread* standing(unsigned thread) const;
  /// A leak of an execution that was none at the time, for nothing of that place had been freed in
  /// any by then.
  [[nodiscard]] std::optional<std::pair<Finding, std::vector<Step>>> late_leak() const;
  /// Where the code allocates what is lost and never freed, which is no finding.
  [[nodiscard]] std::vector<const void*> never_freed() const;
  /// Loops that were taken to wait although their state changed.
  [[nodiscard]] std::size_t assumed_waits() const { return parts_.loops.assumed_waits(); }

 private:
  void run_threads();
  void finish();
  void judge();
  void look_for_leaks();
  [[nodiscard]] std::vector<virtual_cores::Range> roots() const;

  static Execution* running;
  Events events_;
  ExecutionParts& parts_ = events_.parts;
  struct Lost {
    std::size_t bytes;
    std::vector<Step> steps;
  };
  std::map<const void*, Lost> never_freed_;  ///< by place: the first execution that lost some
  Computations computations_{parts_};
  virtual_cores::SpinWatch spin_watch_{parts_.state.cores, computations_};
};

}  // namespace irt::checker
