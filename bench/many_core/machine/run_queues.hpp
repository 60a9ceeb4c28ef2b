/// The kernel's scheduler: which thread has each hardware thread, and which wait for it, in turn.
#pragma once

#include <deque>
#include <vector>

#include "bench/many_core/coherence/costs.hpp"
#include "bench/many_core/machine/state.hpp"

namespace irt::many_core {

class RunQueues {
 public:
  RunQueues(const Profile& profile, State& state);

  /// Time 0: of the threads of a hardware thread the first one runs.
  void start();
  /// A thread that sleeps may go on from `at`, as soon as it has its hardware thread.
  void wake(Thread& thread, Time at);
  /// The same, for the time is over that it wanted to sleep at most.
  void time_out(Thread& thread, Time at);
  /// The thread sleeps or has ended: the next one has its hardware thread.
  void leave(Thread& me);
  /// The thread's turn is over. False if nobody else is ready, and it goes on.
  bool rotate(Thread& me);

 private:
  // One hardware thread, and the threads that run there.
  struct Hardware {
    unsigned running = nobody;
    std::deque<unsigned> ready;
    Time quantum_end = never;
  };

  void run_next(Hardware& hardware, Time at);
  void set_deadline(unsigned place);
  void set_busy(unsigned place, unsigned thread);

  State& state_;
  unsigned smt_;
  LocalCosts alone_, beside_sibling_;
  Time wake_latency_, switch_, quantum_;
  std::vector<Hardware> hardware_;
};

}  // namespace irt::many_core
