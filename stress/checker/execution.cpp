#include "stress/checker/execution.hpp"

#include "stress/checker/leaks.hpp"
#include "stress/checker/standstill.hpp"

namespace irt::checker {

Execution* Execution::running = nullptr;

Outcome Execution::run(Strategy& strategy) {
  ExecutionState& state = parts_.state;
  Conclusion& conclusion = parts_.state.conclusion;
  const Program& program = state.program;
  const auto goes_on = [&] { return conclusion.outcome() == Outcome::complete; };
  running = this;
  parts_.begin(strategy);
  if (program.age != 0) {
    age(state);
    parts_.kernel.begin();
  }
  if (goes_on() && program.prepare) {
    state.phase = Phase::prepare;
    state.run_main(program.prepare);
  }
  if (goes_on()) run_threads();
  if (goes_on()) finish();
  state.phase = Phase::idle;
  if (goes_on()) judge();
  if (goes_on()) look_for_leaks();
  conclusion.forget_known();
  running = nullptr;
  return conclusion.outcome();
}

void Execution::run_threads() {
  ExecutionState& state = parts_.state;
  Conclusion& conclusion = parts_.state.conclusion;
  state.phase = Phase::parallel;
  state.graph.tick(state.threads);
  for (unsigned thread = 0; thread < state.threads; ++thread) {
    state.graph.order(state.threads, thread);
    state.arm(thread, state.program.threads[thread]);
  }
  parts_.turns.start();
  if (conclusion.outcome() == Outcome::complete && state.strategy->books().gives_up)
    conclusion.end(Outcome::cut);
  if (conclusion.outcome() == Outcome::complete)
    conclude_standstill(state, parts_.turns, parts_.loops);
}

void Execution::finish() {
  ExecutionState& state = parts_.state;
  for (unsigned thread = 0; thread < state.threads; ++thread) {
    state.graph.tick(thread);
    state.graph.order(thread, state.threads);
  }
  if (!state.program.finish) return;
  state.phase = Phase::finish;
  state.walk = 0;
  state.run_main(state.program.finish);
}

void Execution::judge() {
  const Program& program = parts_.state.program;
  if (!program.judge) return;
  if (auto wrong = program.judge(*this))
    parts_.state.conclusion.find({FindingKind::wrong_outcome, std::move(*wrong), {}});
}

void Execution::look_for_leaks() {
  ExecutionState& state = parts_.state;
  if (!state.limits.leaks || freezes() || !state.program.finish) return;
  std::vector<virtual_cores::Range> roots = virtual_cores::thread_locals_of(state.threads);
  if (state.program.module != nullptr) {
    const auto& globals = state.program.module->globals();
    roots.insert(roots.end(), globals.begin(), globals.end());
  }
  if (const Block* lost = first_lost(state.heap, roots))
    parts_.state.conclusion.find(
        {FindingKind::leak,
         "a block of " + std::to_string(lost->size) +
             " bytes, allocated at {0}, is never freed, and nothing leads to it",
         {lost->allocated_at}});
}

std::optional<unsigned> Execution::stopped() const {
  return parts_.turns.froze() ? std::optional(parts_.turns.frozen()->first) : std::nullopt;
}

const Turns::Thread* Execution::standing(unsigned thread) const {
  const Turns::Thread& t = parts_.turns.of(thread);
  return !t.done && t.waiting && t.wait_pc != nullptr ? &t : nullptr;
}

}  // namespace irt::checker
