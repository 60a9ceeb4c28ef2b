#include "stress/checker/progress.hpp"

#include "stress/checker/random.hpp"

namespace irt::checker {

namespace {

/// A random schedule with as few switches as a real one, and memory as it is on most days.
class Calm final : public RandomBase {
 public:
  using RandomBase::RandomBase;

 protected:
  std::uint32_t choose(ChoiceKind kind, std::uint32_t count) override {
    if (kind != ChoiceKind::thread) return 0;
    return generator_.below(3) != 0 ? 0 : generator_.below(count);
  }
};

}  // namespace

ProgressResult check_progress(const Program& program, const Limits& limits, std::uint64_t seed,
                              unsigned schedules, double seconds,
                              const std::function<void(const Execution&)>& look) {
  ProgressResult result;
  const Deadline deadline(seconds);
  Execution execution(program, limits);
  execution.conclusion().until(deadline);
  for (unsigned thread = 0; thread < execution.threads(); ++thread) {
    bool reached = true;
    for (std::size_t step = 0; reached && step < limits.events_per_thread; ++step) {
      reached = false;
      execution.freeze(thread, step);
      Calm strategy(seed);
      for (unsigned i = 0; i < schedules; ++i) {
        strategy.begin();
        Outcome outcome = execution.run(strategy);
        while (outcome == Outcome::restart) outcome = execution.run(strategy);
        result.incomplete = execution.conclusion().incomplete();
        result.incomplete_at = execution.conclusion().incomplete_at();
        if (execution.conclusion().out_of_time() || deadline.passed()) return result;
        ++result.executions;
        reached = reached || execution.stopped();
        if (outcome != Outcome::found || !execution.stopped()) continue;
        result.finding = execution.finding();
        result.finding->kind = FindingKind::blocked_by_stalled_thread;
        result.steps = execution.steps();
        result.thread = thread;
        result.stopped = step;
        if (look) look(execution);
        return result;
      }
    }
  }
  result.finished = result.incomplete.empty();
  return result;
}

}  // namespace irt::checker
