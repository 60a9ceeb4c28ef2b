#include "stress/checker/alone.hpp"

#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace irt::checker {

void Alone::start_looking() {
  watch_.begin();
  looks_ = 0;
}

void Alone::begin() {
  state_.phase = Phase::endless;
  start_looking();
}

// For plain accesses nothing is known of the code's registers, so that it must come by the same
// place and address, with memory as it was, as often as a loop may look.
void Alone::walk(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                 const void* pc) {
  constexpr std::uint64_t longest_walk = 200'000'000;
  constexpr std::uint64_t shortest_look = 1U << 16U;
  if (state_.walk > longest_walk)
    state_.conclusion.give_up(
        fmt::format("an execution makes more than {} accesses between two steps", longest_walk));
  state_.conclusion.check_time();
  const std::uint64_t walked = state_.walk - long_walk;
  // One part in eight of the way to twice the length, so that work is not slowed down much, and the
  // longest loop is met at last.
  const std::uint64_t power = std::bit_floor(std::max(walked, shortest_look));
  if (walked == 1 || walked == power) start_looking();
  if (walked >= shortest_look && walked - power >= power / 8) return;
  if (writes) {
    if (!state_.on_own_stack(address)) watch_.note_write(address, size);
    return;
  }
  if (atomic || !watch_.repeats(address ^ reinterpret_cast<std::uintptr_t>(pc))) return;
  if (++looks_ > state_.limits.looks)
    state_.conclusion.report(FindingKind::livelock,
                             "the plain read at {0} is repeated for ever: nothing changes", {pc});
}

void Alone::pass_unwatched() {
  // A call that makes more is taken for one that does not return.
  constexpr std::uint64_t longest_call = 10'000'000;
  ++state_.beats;
  if (state_.phase == Phase::ageing && ++state_.walk > longest_call)
    state_.conclusion.give_up(fmt::format(
        "a call while the queue is aged makes more than {} accesses to memory", longest_call));
}

void Alone::step(std::uintptr_t address, std::size_t size, bool writes, const void* pc) {
  if (state_.phase != Phase::endless && state_.walk <= long_walk) return;
  if (writes && !is_made_up(address)) watch_.note_write(address, size);
  look(pc);
}

void Alone::conclude(bool endless, const void* pc) {
  if (state_.phase != Phase::endless)
    state_.conclusion.report(
        FindingKind::livelock,
        "the only thread loops at {0} for ever: it comes back to the state that it was in", {pc});
  const auto shared = [this](std::uintptr_t address) {
    return state_.heap.toucher(address) != state_.current() + 1;
  };
  if (!endless || !watch_.restored(shared))
    state_.conclusion.give_up(
        fmt::format("a thread makes more than {} steps", state_.limits.events_per_thread));
  state_.phase = Phase::parallel;
  Turns::Thread& me = turns_.mine();
  me.endless = me.waiting = true;
  me.assumed = false;
  me.location = 0;
  me.wait_pc = pc;
  state_.cores.switch_to(virtual_cores::host);
}

// Called at each read of the only thread.
void Alone::look(const void* pc) {
  ++looks_;
  state_.conclusion.check_time();
  if (virtual_cores::registers().stack_pointer != 0 &&
      watch_.repeats(state_.hash_of_core() ^ reinterpret_cast<std::uintptr_t>(pc)))
    conclude(true, pc);
  if (looks_ <= state_.limits.looks) return;
  if (state_.phase == Phase::endless) conclude(true, pc);
  if (watch_.restored([](std::uintptr_t) { return true; }))
    state_.conclusion.report(
        FindingKind::livelock,
        fmt::format("the only thread loops at {{0}}: in {} looks nothing but counters of its own "
                    "has changed",
                    looks_),
        {pc});
  start_looking();
}

}  // namespace irt::checker
