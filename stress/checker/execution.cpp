#include "stress/checker/execution.hpp"

#include "stress/checker/leaks.hpp"
#include "stress/checker/standstill.hpp"

namespace irt::checker {

namespace {

Finding leak_of(std::size_t bytes, const void* place) {
  return {FindingKind::leak,
          "a block of " + std::to_string(bytes) +
              " bytes, allocated at {0}, is never freed, and nothing leads to it",
          {place}};
}

}  // namespace

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
  for (unsigned thread = 0; thread < state.program.threads.size(); ++thread) {
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

std::vector<virtual_cores::Range> Execution::roots() const {
  const ExecutionState& state = parts_.state;
  std::vector<virtual_cores::Range> roots = virtual_cores::thread_locals_of(state.threads);
  if (state.program.module != nullptr) {
    const auto& globals = state.program.module->globals();
    roots.insert(roots.end(), globals.begin(), globals.end());
  }
  // What the threads of a process have in hand when it ends.
  for (const unsigned thread : state.program.own_threads != 0 ? born() : std::vector<unsigned>{}) {
    const auto locals = virtual_cores::thread_locals_of(thread);
    roots.insert(roots.end(), locals.begin(), locals.end());
    if (parts_.process.in_midst(thread)) roots.push_back(state.cores.frames_of(thread));
  }
  return roots;
}

void Execution::look_for_leaks() {
  ExecutionState& state = parts_.state;
  const bool looks = state.program.finish || state.program.own_threads != 0;
  if (!state.limits.leaks || freezes() || !looks) return;
  for (const Block* lost : lost_blocks(state.heap, roots())) {
    const void* const place = lost->allocated_at;
    if (state.limits.kept_memory_leaks || parts_.allocations.frees_from(place))
      return parts_.state.conclusion.find(leak_of(lost->size, place));
    never_freed_.try_emplace(place, Lost{lost->size, steps_as_born()});
  }
}

std::optional<std::pair<Finding, std::vector<Step>>> Execution::late_leak() const {
  for (const auto& [place, lost] : never_freed_)
    if (parts_.allocations.frees_from(place)) return {{leak_of(lost.bytes, place), lost.steps}};
  return std::nullopt;
}

std::vector<const void*> Execution::never_freed() const {
  std::vector<const void*> places;
  for (const auto& [place, lost] : never_freed_) places.push_back(place);
  return places;
}

std::vector<Step> Execution::steps_as_born() const {
  std::vector<Step> steps = this->steps();
  std::vector<std::uint8_t> number(threads());
  for (std::size_t i = 0; i < born().size(); ++i) number[born()[i]] = static_cast<std::uint8_t>(i);
  for (Step& step : steps) step.thread = number[step.thread];
  return steps;
}

std::optional<unsigned> Execution::stopped() const {
  return parts_.turns.froze() ? std::optional(parts_.turns.frozen()->first) : std::nullopt;
}

const Turns::Thread* Execution::standing(unsigned thread) const {
  const Turns::Thread& t = parts_.turns.of(thread);
  return !t.done && t.waiting && t.wait_pc != nullptr ? &t : nullptr;
}

}  // namespace irt::checker
