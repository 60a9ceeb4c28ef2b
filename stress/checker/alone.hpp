/// Code that runs on alone, without events or after too many of them: whether it ever ends. Memory
/// holds every value then.
#pragma once

#include <cstdint>

#include "stress/checker/cycle_watch.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

class Alone {
 public:
  /// After so many accesses without an event it is asked whether they ever end.
  static constexpr std::uint64_t long_walk = 1'000'000;

  Alone(ExecutionState& state, Turns& turns) : state_(state), turns_(turns) {}

  /// The thread in progress makes no more events that count: from here on it runs alone.
  void begin();
  /// It does what cannot be compared with what was before.
  void forget() { watch_.begin(); }
  void note_write(std::uintptr_t address, std::size_t size) { watch_.note_write(address, size); }
  /// One access more without an event, the `state_.walk`-th.
  void walk(std::uintptr_t address, std::size_t size, bool writes, bool atomic, const void* pc);
  /// The same for what nobody watches.
  void pass_unwatched();
  /// The same for an atomic access outside of the threads' time.
  void step(std::uintptr_t address, std::size_t size, bool writes, const void* pc);
  /// It is known whether it ends, or else it is given up.
  void conclude(bool endless, const void* pc);
  /// It goes on to what is no access to memory, which can be repeated for no reason.
  void move_on(const void* pc) {
    if (state_.phase == Phase::endless) conclude(false, pc);
  }

 private:
  void start_looking();
  void look(const void* pc);

  ExecutionState& state_;
  Turns& turns_;
  CycleWatch watch_;
  std::uint64_t looks_ = 0;
};

}  // namespace irt::checker
