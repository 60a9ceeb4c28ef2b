/// What threads ask of a kernel, put into the graph: locks and futexes, and what programs wait for
/// each other by. Each is an object at an address that no program has; time and random numbers are
/// the same in every execution.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/checker/accesses.hpp"
#include "stress/checker/alone.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/loops.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

class Kernel {
 public:
  Kernel(ExecutionState& state, Turns& turns, Alone& alone, Loops& loops, Accesses& accesses)
      : state_(state),
        turns_(turns),
        alone_(alone),
        loops_(loops),
        accesses_(accesses),
        asked_(state.threads + 1) {}

  /// The next execution begins.
  void begin() {
    for (Asked& asked : asked_) {
      asked.random = 0;
      asked.clock.clear();
    }
  }

  // See Tenant.
  bool lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc);
  bool try_lock(std::uintptr_t address, const void* pc);
  void unlock(std::uintptr_t address, const void* pc);
  virtual_cores::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                           const void* pc);
  unsigned wake(std::uintptr_t address, unsigned count, const void* pc);
  void sleep(std::int64_t nanoseconds) { pass(nanoseconds); }
  std::int64_t now();
  std::uint64_t random();

  /// "goes to sleep", "wakes thread 1": what an event of the kernel's own at `address` is; "" if it
  /// is none.
  static std::string what_is(std::uintptr_t address, const Event& event);

  // For programs.
  /// Lets those that await it go on; what came before happens before what they do.
  void signal();
  void await_signal();
  /// Waits until `threads` threads have come here as often as this one; what each did before
  /// happens before what any does afterwards. While the threads run only.
  void meet(unsigned threads);
  /// The time on a clock that all threads read in one order, and that makes nothing they did before
  /// visible to the others. From 1 on; 0 before and after the threads.
  std::uint64_t tick();
  /// The time on the clock that the code of the thread in progress sees, in nanoseconds. It passes
  /// with each look, with sleep and where a wait with a time-out is in vain; it is never earlier
  /// than what another thread saw on it before.
  [[nodiscard]] std::int64_t time() const;

 private:
  /// The time on a thread's clock after so many events of its own.
  struct Reading {
    std::uint16_t moment;
    std::int64_t time;
  };
  struct Asked {
    std::uint64_t random = 0;
    std::vector<Reading> clock;
  };

  void pass(std::int64_t nanoseconds);

  virtual_cores::Wake wait_alone(std::uintptr_t address, std::uint32_t expected,
                                 std::int64_t nanoseconds, const void* pc);
  bool times_out(std::int64_t nanoseconds, const void* pc);
  void look_outside();

  ExecutionState& state_;
  Turns& turns_;
  Alone& alone_;
  Loops& loops_;
  Accesses& accesses_;
  std::vector<Asked> asked_;  ///< by thread
};

}  // namespace irt::checker
