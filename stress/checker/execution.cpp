#include "stress/checker/execution.hpp"

#include <algorithm>

#include "stress/checker/leaks.hpp"

namespace irt::checker {

using virtual_cores::host;

namespace {

// What Linux gives one.
constexpr std::size_t stack_of_a_thread = std::size_t{8} << 20U;

// `work` must live as long as the core runs.
void arm(virtual_cores::Cores& cores, unsigned core, const std::function<void()>& work) {
  const auto enter = [](void* w) { (*static_cast<const std::function<void()>*>(w))(); };
  cores.arm(core, enter, const_cast<std::function<void()>*>(&work));
}

}  // namespace

Execution* Execution::running = nullptr;

Execution::Execution(const Program& program, const Limits& limits)
    : program_(program),
      limits_(limits),
      main_(static_cast<unsigned>(program.threads.size())),
      cores_(*this, main_ + 1, stack_of_a_thread),
      graph_(main_ + 1),
      heap_(main_ + 1),
      states_(main_ + 1),
      stack_bytes_(cores_.stack_bytes()) {
  for (unsigned core = 0; core <= main_; ++core) stacks_.push_back(cores_.stack_of(core));
}

Outcome Execution::run(Strategy& strategy) {
  strategy_ = &strategy;
  running = this;
  graph_.clear();
  heap_.clear();
  steps_.clear();
  if (diary_ != nullptr) diary_->clear();
  finding_.reset();
  froze_ = out_of_time_ = false;
  stores_ = walk_ = 0;
  failed_at_.clear();
  outcome_ = Outcome::complete;
  for (ThreadState& state : states_) {
    std::vector<Visit> visits = std::move(state.visits);
    visits.clear();
    state = ThreadState{};
    state.visits = std::move(visits);
  }
  if (program_.module != nullptr) program_.module->reset_globals();

  if (program_.age != 0) begin_aged();
  if (outcome_ == Outcome::complete && program_.prepare) {
    phase_ = Phase::prepare;
    run_main(program_.prepare);
  }
  if (outcome_ == Outcome::complete) {
    phase_ = Phase::parallel;
    graph_.tick(main_);
    for (unsigned thread = 0; thread < main_; ++thread) {
      graph_.order(main_, thread);
      arm(cores_, thread, program_.threads[thread]);
    }
    const unsigned first = strategy.choose_thread(*this, runnable(), host);
    if (first == host)
      outcome_ = Outcome::cut;
    else
      cores_.run(first);
    if (outcome_ == Outcome::complete && strategy.gives_up()) outcome_ = Outcome::cut;
    if (outcome_ == Outcome::complete) outcome_ = after_threads();
  }
  if (outcome_ == Outcome::complete) {
    for (unsigned thread = 0; thread < main_; ++thread) {
      graph_.tick(thread);
      graph_.order(thread, main_);
    }
    if (program_.finish) {
      phase_ = Phase::finish;
      walk_ = 0;
      run_main(program_.finish);
    }
  }
  phase_ = Phase::idle;
  if (outcome_ == Outcome::complete && program_.judge) {
    if (auto wrong = program_.judge(*this)) {
      finding_ = Finding{FindingKind::wrong_outcome, std::move(*wrong), {}};
      outcome_ = Outcome::found;
    }
  }
  if (outcome_ == Outcome::complete && limits_.leaks && !frozen_ && program_.finish) {
    std::vector<virtual_cores::Range> roots = virtual_cores::thread_locals_of(main_);
    if (program_.module != nullptr) {
      const auto& globals = program_.module->globals();
      roots.insert(roots.end(), globals.begin(), globals.end());
    }
    if (const Block* lost = first_lost(heap_, roots)) {
      finding_ = Finding{FindingKind::leak,
                         "a block of " + std::to_string(lost->size) +
                             " bytes, allocated at {0}, is never freed, and nothing leads to it",
                         {lost->allocated_at}};
      outcome_ = Outcome::found;
    }
  }
  if (outcome_ == Outcome::found && knows(finding_->kind, finding_->places, finding_->text)) {
    outcome_ = Outcome::cut;
    if (incomplete_.empty()) incomplete_ = "some executions end in what is reported already";
  }
  running = nullptr;
  strategy.end(*this, outcome_);
  return outcome_;
}

bool Execution::is_stack(std::uintptr_t address) const {
  return std::any_of(stacks_.begin(), stacks_.end(),
                     [&](std::uintptr_t stack) { return address - stack < stack_bytes_; });
}

bool Execution::is_global(std::uintptr_t address) const {
  return program_.module != nullptr && program_.module->owns_global(address);
}

void Execution::run_main(const std::function<void()>& work) {
  arm(cores_, main_, work);
  cores_.run(main_);
}

// --- Who runs -------------------------------------------------------------------------------

std::uint32_t Execution::runnable() const {
  std::uint32_t mask = 0;
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    if (state.waiting && (!strategy_->resumes_waiting() || stores_ <= state.waits_since)) continue;
    mask |= 1U << thread;
  }
  return mask;
}

void Execution::stop(Outcome outcome) {
  outcome_ = outcome;
  cores_.switch_to(host);
  std::abort();
}

void Execution::stop_in_time() {
  if (!deadline_.passed()) return;
  out_of_time_ = true;
  stop(Outcome::cut);
}

bool Execution::knows(FindingKind kind, const std::vector<const void*>& places,
                      std::string_view text) const {
  return std::any_of(known_.begin(), known_.end(), [&](const Finding& known) {
    return same_place(known, {kind, std::string(text), places});
  });
}

void Execution::report(FindingKind kind, std::string text, std::vector<const void*> places,
                       std::vector<Moment> moments) {
  finding_ = Finding{kind, std::move(text), std::move(places), std::move(moments)};
  stop(Outcome::found);
}

std::optional<Execution::Standing> Execution::standing(unsigned thread) const {
  const ThreadState& state = states_[thread];
  if (state.done || state.wait_pc == nullptr || !state.waiting) return std::nullopt;
  return Standing{state.wait_pc, state.wait_location, state.wait_sleeps};
}

std::string Execution::stalled() const {
  return "with thread " + std::to_string(frozen_->first) + " stopped after " +
         std::to_string(frozen_->second) + " steps, ";
}

void Execution::reach(std::uintptr_t address, bool writes) {
  ThreadState& state = me();
  if (phase_ != Phase::parallel) return;
  if (diary_ != nullptr) diary_->settle(cores_.current());
  if (frozen_ && frozen_->first == cores_.current() &&
      graph_.thread(frozen_->first).events.size() >= frozen_->second) {
    froze_ = state.done = true;
    go_elsewhere();
  }
  if (!state.started) {  // it was chosen to begin, and nothing has happened since
    state.started = true;
    return;
  }
  state.pending = address;
  state.pending_writes = writes;
  const unsigned next = strategy_->choose_thread(*this, runnable(), cores_.current());
  if (next == host) stop(Outcome::cut);
  cores_.switch_to(next);
}

void Execution::go_elsewhere() {
  const unsigned next = finished(host);
  if (next == host) cores_.switch_to(host);
  cores_.switch_to(next);
}

unsigned Execution::finished(unsigned core) {
  if (diary_ != nullptr && core != host) diary_->settle(core);
  if (phase_ == Phase::endless) conclude_alone(false, nullptr);
  if (phase_ != Phase::parallel) return host;
  if (core != host) states_[core].done = true;
  std::uint32_t mask = runnable();
  if (mask == 0) {
    // Another execution goes on where this one has a thread wait for a store that is there by now.
    const bool goes_on = std::any_of(states_.begin(), states_.end() - 1, [this](const auto& s) {
      return !s.done && s.waiting && !s.assumed && stores_ > s.waits_since;
    });
    if (goes_on) return host;
    // Nobody else: a loop that only looked like waiting may still come to an end by itself, or
    // bring another one to its end. Who had the fewest turns is next.
    ThreadState* next = nullptr;
    for (unsigned thread = 0; thread < main_; ++thread) {
      ThreadState& state = states_[thread];
      if (state.done || !state.assumed || (next != nullptr && next->turns <= state.turns)) continue;
      next = &state;
      mask = 1U << thread;
    }
    if (next == nullptr) return host;
    ++next->turns;
    next->assumed = next->waiting = false;
    // But not by reading again and again what is old by now: that would be unfair.
    next->fresh_reads = ~std::uint32_t{0};
  }
  const unsigned next = strategy_->choose_thread(*this, mask, cores_.current());
  if (next == host) outcome_ = Outcome::cut;
  return next;
}

void Execution::wait_here(std::uint32_t location, const void* pc) {
  ThreadState& state = me();
  if (phase_ != Phase::parallel) {
    report(FindingKind::deadlock, "the only thread waits at {0} for a store that nobody makes",
           {pc});
  }
  state.waiting = true;
  state.wait_location = location;
  state.waits_since = stores_;
  state.wait_pc = pc;
  go_elsewhere();
  state.waiting = false;
}

Outcome Execution::after_threads() {
  if (std::all_of(states_.begin(), states_.end() - 1, [](const ThreadState& s) { return s.done; }))
    return Outcome::complete;
  // Some wait. It is for good only if each has seen the newest store of all it waits for.
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    if (state.timed || state.assumed) return Outcome::blocked;
    if (state.endless) continue;
    if (state.wait_location != 0) {
      const std::vector<EventId>& events = graph_.thread(thread).events;
      if (events.empty()) continue;
      const Event& last = graph_.event(events.back());
      if (last.blocked && !is_newest(source_of(last.from))) return Outcome::blocked;
    } else if (!sees_newest(thread)) {
      return Outcome::blocked;
    }
  }
  explain_standstill();
  return Outcome::found;
}

void Execution::explain_standstill() {
  Finding finding{FindingKind::deadlock, "", {}};
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    const std::string place = "{" + std::to_string(finding.places.size()) + "}";
    finding.places.push_back(state.wait_pc);
    if (!finding.text.empty()) finding.text += "; ";
    finding.text += "thread " + std::to_string(thread);
    if (state.wait_sleeps) {
      finding.text += " sleeps at " + place + " and nobody is left to wake it";
    } else if (state.wait_location != 0) {
      finding.text += " waits at " + place + " for a lock that is never released";
    } else {
      finding.text += " loops at " + place + " for a store that nobody makes";
      finding.kind = FindingKind::livelock;
    }
  }
  if (frozen_) {
    finding.kind = FindingKind::blocked_by_stalled_thread;
    finding.text = stalled() + finding.text;
  }
  finding_ = finding;
}

void Execution::on_failure(const std::string& what, const void* pc) {
  finding_ = Finding{FindingKind::failure, pc != nullptr ? what + " at {0}" : what, {}};
  if (pc != nullptr) finding_->places.push_back(pc);
  stop(Outcome::found);
}

}  // namespace irt::checker
