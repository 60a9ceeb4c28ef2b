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
  std::string repeat;  ///< the command line that repeats it
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

/// Whether `pop` of an empty queue returns. Tries it in a child process; takes more than a second
/// if it does not.
bool pop_answers_on_empty(const QueueEntry& queue);

/// Memory held against live elements.
void run_memory(const Assignment& assignment, Messenger& messenger);

}  // namespace irt::stress
