/// Who goes on: the strategy chooses among the threads that do not wait; a thread may be stopped
/// for good.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "stress/checker/execution_state.hpp"

namespace irt::checker {

class Turns {
 public:
  struct Thread {
    bool unborn = false;  ///< nobody has begun it
    bool started = false;
    bool done = false;  ///< came to its end, or was stopped for good
    bool waiting = false;
    bool assumed = false;           ///< waits only because it looked like a loop
    bool timed = false;             ///< waits with a time-out
    bool sleeps = false;            ///< in a futex, not for a lock or in a loop
    bool endless = false;           ///< goes on for ever if nobody stores anything
    std::uint32_t turns = 0;        ///< how often it went on because nobody else could
    std::uint32_t fresh_reads = 0;  ///< that many loads must read the newest store
    std::uint32_t location = 0;     ///< that it waits for, plus one; 0: any store
    std::uint64_t waits_since = 0;  ///< stores in the execution by then
    const void* wait_pc = nullptr;
    const char* wait_for = "a lock that is never released";
  };

  explicit Turns(ExecutionState& state) : state_(state), all_(state.threads + 1) {}

  /// The next execution begins.
  void begin();
  /// Starts the threads.
  void start();

  /// The thread in progress is about to make an event; others may come first.
  void reach(std::uintptr_t address, bool writes);
  /// It waits for a store to `location` (plus one; 0: any).
  void wait(std::uint32_t location, const void* pc);
  /// `thread` has come to its end: who goes on, or `host`.
  unsigned after(unsigned thread) {
    all_[thread].done = true;
    return next();
  }

  /// From now on no other thread comes between the events of the one in progress, as far as the
  /// strategy may choose, or others may again.
  void keep(bool turn) { kept_ = turn; }
  /// What the thread in progress has come to cannot be, or is of no interest: it goes no further.
  /// Others do, for what they store may let an execution begin in which all is well.
  [[noreturn]] void dismiss(const void* pc);

  /// Somebody has begun `thread`.
  void bear(unsigned thread) { all_[thread].unborn = false; }
  /// The process has ended: who waits from now on need not go on.
  void end_process() { over_ = true; }
  [[nodiscard]] bool over() const { return over_; }

  Thread& mine() { return all_[state_.current()]; }
  [[nodiscard]] const Thread& of(unsigned thread) const { return all_[thread]; }

  /// Stops `thread` for good before event number `events` (from 0) of its own, from now on.
  void freeze(unsigned thread, std::size_t events) { frozen_ = {{thread, events}}; }
  [[nodiscard]] const std::optional<std::pair<unsigned, std::size_t>>& frozen() const {
    return frozen_;
  }
  /// Whether it came that far in the last execution.
  [[nodiscard]] bool froze() const { return froze_; }

 private:
  unsigned next();
  /// Threads that could go on, as bits.
  [[nodiscard]] std::uint32_t runnable() const;
  unsigned choose(std::uint32_t runnable, unsigned current) {
    return state_.strategy->choose_thread(state_, runnable, current);
  }

  ExecutionState& state_;
  std::vector<Thread> all_;
  std::optional<std::pair<unsigned, std::size_t>> frozen_;
  bool froze_ = false;
  bool over_ = false;
  bool kept_ = false;
};

}  // namespace irt::checker
