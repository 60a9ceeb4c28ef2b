/// The suites. Each runs in a child process, tells its findings to the messenger and returns.
#pragma once

#include <cstdint>
#include <string>

#include "queues/work_queue.hpp"
#include "stress/history/clock.hpp"
#include "stress/scenarios/scenarios.hpp"
#include "stress/threads/child.hpp"

namespace irt::stress {

/// What a suite is told.
struct Assignment {
  const QueueEntry& queue;
  const ClockQuality& clock;
  double seconds = 1;
  std::uint64_t seed = 1;
  std::string repeat;      ///< the command line that repeats it
  bool pop_waits = false;  ///< `pop` does not answer *empty*: it waits until `close_word`
};

/// Rounds of one scenario, short and long, disturbed and not, each on a new queue and judged by the
/// oracles, until the time is up or a claim is broken.
void run_scenario(const Assignment& assignment, const Scenario& scenario, Messenger& messenger);

/// Suspends threads in the middle of operations, thousands of times, and sees who can go on.
void run_progress(const Assignment& assignment, Messenger& messenger);

/// Lets the k-th allocation fail, for every k.
void run_faults(const Assignment& assignment, Messenger& messenger);

/// Long runs without logs, counted at moments at which everybody stands still.
void run_sustained(const Assignment& assignment, Messenger& messenger);

/// What `pop` does on an empty queue.
enum class OnEmpty : std::uint8_t {
  answers,         ///< false, as the contract says
  waits,           ///< waits until `close_word` is pushed, then answers false
  waits_for_ever,  ///< waits, whatever is pushed but an element
};

/// Finds out by trying, in a child process; takes more than a second if `pop` waits.
OnEmpty find_on_empty(const QueueEntry& queue);

/// Memory held against live elements.
void run_memory(const Assignment& assignment, Messenger& messenger);

}  // namespace irt::stress
