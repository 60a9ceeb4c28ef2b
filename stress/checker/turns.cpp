#include "stress/checker/turns.hpp"

#include <algorithm>

namespace irt::checker {

using virtual_cores::host;

void Turns::begin() {
  std::ranges::fill(all_, Thread{});
  for (std::size_t thread = state_.program.threads.size(); thread < state_.threads; ++thread)
    all_[thread].unborn = true;
  froze_ = over_ = kept_ = false;
}

void Turns::start() {
  const unsigned first = choose(runnable(), host);
  if (first == host)
    state_.conclusion.end(Outcome::cut);
  else
    state_.cores.run(first);
}

std::uint32_t Turns::runnable() const {
  std::uint32_t mask = 0;
  for (unsigned thread = 0; thread < state_.threads; ++thread) {
    const Thread& t = all_[thread];
    if (t.done || t.unborn) continue;
    if (t.waiting && (!state_.strategy->resumes_waiting() || state_.stores <= t.waits_since))
      continue;
    mask |= 1U << thread;
  }
  return mask;
}

void Turns::reach(std::uintptr_t address, bool writes) {
  if (state_.phase != Phase::parallel) return;
  const unsigned thread = state_.current();
  Thread& me = all_[thread];
  if (state_.diary != nullptr) state_.diary->settle(thread);
  if (frozen_ && frozen_->first == thread && state_.events_of(thread) >= frozen_->second) {
    froze_ = me.done = true;
    kept_ = false;
    state_.cores.switch_to(next());
  }
  if (!me.started) {  // it was chosen to begin, and nothing has happened since
    me.started = true;
    return;
  }
  state_.pending[thread] = {address, writes};
  if (kept_ && state_.strategy->resumes_waiting()) return;  // it samples, and plans nothing
  const unsigned chosen = choose(runnable(), thread);
  if (chosen == host) state_.conclusion.stop(Outcome::cut);
  state_.cores.switch_to(chosen);
}

void Turns::wait(std::uint32_t location, const void* pc) {
  if (state_.phase != Phase::parallel)
    state_.conclusion.report(FindingKind::deadlock,
                             "the only thread waits at {0} for a store that nobody makes", {pc});
  Thread& me = mine();
  me.waiting = true;
  me.location = location;
  me.waits_since = state_.stores;
  me.wait_pc = pc;
  state_.cores.switch_to(next());
  me.waiting = false;
}

void Turns::dismiss(const void* pc) {
  mine().timed = true;  // so that it is no deadlock
  for (;;) wait(0, pc);
}

unsigned Turns::next() {
  std::uint32_t mask = runnable();
  if (mask == 0 && over_) return host;
  if (mask == 0) {
    // Another execution goes on where this one has a thread wait for a store that is there by now.
    const bool goes_on = std::any_of(all_.begin(), all_.end() - 1, [this](const Thread& t) {
      return !t.done && t.waiting && !t.assumed && state_.stores > t.waits_since;
    });
    if (goes_on) return host;
    // Nobody else: a loop that only looked like waiting may still come to an end by itself, or
    // bring another one to its end. Who had the fewest turns is next.
    Thread* last = nullptr;
    for (unsigned thread = 0; thread < state_.threads; ++thread) {
      Thread& t = all_[thread];
      if (t.done || !t.assumed || (last != nullptr && last->turns <= t.turns)) continue;
      last = &t;
      mask = 1U << thread;
    }
    if (last == nullptr) return host;
    ++last->turns;
    last->assumed = last->waiting = false;
    // But not by reading again and again what is old by now: that would be unfair.
    last->fresh_reads = ~std::uint32_t{0};
  }
  const unsigned chosen = choose(mask, state_.current());
  if (chosen == host) state_.conclusion.end(Outcome::cut);
  return chosen;
}

}  // namespace irt::checker
