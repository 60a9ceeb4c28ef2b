#include "bench/many_core/machine/spin_loops.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace irt::many_core {

namespace {

constexpr unsigned rounds_before_looking = 3;  // hashing the state costs more than a round

// The callee-saved registers and the stack: all that a loop can carry from one round to the next.
std::uint64_t hash_of_state(const Thread& thread) {
  const virtual_cores::Registers& r = virtual_cores::registers();
  if (r.stack_pointer == 0) return 0;
  // Four hashes side by side, since each step of one waits for its last.
  std::array<std::uint64_t, 4> hashes{1, 2, 3, 4};
  const auto mix = [](std::uint64_t& hash, std::uint64_t word) {
    hash = (hash ^ word) * 0xFF51AFD7ED558CCD;
    hash ^= hash >> 32U;
  };
  std::size_t which = 0;
  for (const std::uint64_t each : {r.rbx, r.rbp, r.r12, r.r13, r.r14, r.r15, r.stack_pointer})
    mix(hashes[which++ % 4], each);
  // NOLINTBEGIN(performance-no-int-to-ptr)
  const auto* word = reinterpret_cast<const std::uint64_t*>(r.stack_pointer);
  const auto* end = reinterpret_cast<const std::uint64_t*>(thread.stack + thread.stack_bytes);
  // NOLINTEND(performance-no-int-to-ptr)
  for (; end - word >= 4; word += 4)
    for (std::size_t i = 0; i < 4; ++i) mix(hashes[i], word[i]);
  for (; word < end; ++word) mix(hashes[0], *word);
  std::uint64_t all = 0;
  for (const std::uint64_t hash : hashes) mix(all, hash);
  return all | 1U;
}

}  // namespace

void SpinLoops::note_watch(LoopState& loop, Line& line) {
  if (loop.lines > LoopState::max_lines) return;
  for (unsigned i = 0; i < loop.lines; ++i)
    if (loop.watches[i].line == &line) return;
  if (loop.lines < LoopState::max_lines) loop.watches[loop.lines].line = &line;
  ++loop.lines;
}

void SpinLoops::note_round(Thread& me, const virtual_cores::Access& access) {
  LoopState& loop = me.loop;
  if (access.pc != loop.pc || access.address != loop.address) {
    loop.pc = access.pc;
    loop.address = access.address;
    loop.has_slept = false;
    loop.rounds = 0;
  } else if (loop.changes != me.changes) {
    loop.rounds = 0;
  } else {
    ++loop.rounds;
  }
  if (loop.rounds >= (loop.has_slept ? 1 : rounds_before_looking)) {
    const std::uint64_t state = hash_of_state(me);
    if (state != 0 && state == loop.state && loop.lines != 0 &&
        loop.lines <= LoopState::max_lines && me.stores.empty())
      sleep(me);
    loop.state = state;
  } else {
    loop.state = 0;
  }
  loop.age = 0;
  loop.lines = 0;
  loop.clock = me.clock;
  loop.changes = me.changes;
  loop.failures = me.failures;
}

void SpinLoops::sleep(Thread& me) {
  LoopState& loop = me.loop;
  const Time period = me.clock - loop.clock;
  State& state = loop_.state();
  loop_.sync(me);
  const bool all_held =
      std::ranges::all_of(std::span(loop.watches).first(loop.lines),
                          [&me](const Watch& w) { return w.line->held_by(me.core); });
  if (period <= 0 || !all_held || me.clock >= me.deadline) return;
  for (unsigned i = 0; i < loop.lines; ++i) {
    Watch& watch = loop.watches[i];
    watch.before = nullptr;
    watch.next = watch.line->watchers;
    if (watch.next != nullptr) watch.next->before = &watch;
    watch.line->watchers = &watch;
  }
  const Time since = me.clock;
  loop.period = period;
  loop.has_slept = true;
  // It looks up when time is over, since that may be what it waits for.
  const Time end = state.measurement.end;
  const Time alarm = me.clock < end ? std::min(me.deadline, end) : me.deadline;
  state.events.push(me.event, since + (alarm - since + period - 1) / period * period);
  loop_.wait();
  loop.period = 0;
  for (unsigned i = 0; i < loop.lines; ++i) {
    Watch& watch = loop.watches[i];
    (watch.before == nullptr ? watch.line->watchers : watch.before->next) = watch.next;
    if (watch.next != nullptr) watch.next->before = watch.before;
  }
  const auto rounds = static_cast<std::uint64_t>((me.clock - since) / period);
  me.failures += rounds * (me.failures - loop.failures);
  state.measurement.note_wait(Cause::spinning, since, me.clock);
  ++me.changes;  // what it reads now may differ
}

}  // namespace irt::many_core
