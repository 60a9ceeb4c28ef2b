/// Each repetition in a process of its own: whatever a queue does there, the sweep goes on.
#pragma once

#include <atomic>
#include <filesystem>

#include "bench/contention/job.hpp"
#include "stress/running/child_process.hpp"

namespace irt::contention {

/// A process that measures one job, turn by turn. A fresh program, not a copy of this one, so that
/// the addresses of code and data are drawn anew for each repetition.
class MeasuringChild {
 public:
  /// Starts `program` with the argument `child_command`, which must call `run_as_child`; there the
  /// queue is made and warmed up. Throws std::runtime_error where no process can be started.
  MeasuringChild(const std::filesystem::path& program, const Job& job);

  /// Waits until it is ready for its first turn. Of this and `take_turn`: false where the child
  /// will take no turn any more, because it has died, was killed for being silent for longer than
  /// it may be, or because `cancel` was set; `finish` says what became of it.
  bool ready(const std::atomic<bool>& cancel);
  /// Lets it take a turn.
  bool take_turn(const std::atomic<bool>& cancel);
  /// Lets it stop its threads and add up the elements. The sample means nothing where `cancel` was
  /// set.
  Sample finish(const std::atomic<bool>& cancel);

  /// Holds all its threads, and lets them go on.
  void hold() { process_.stop(); }
  void let_go() const { process_.go_on(); }

 private:
  [[nodiscard]] double patience() const;

  Job job_;
  ChildProcess process_;
};

/// Reads a job from standard input, measures it, taking each turn when it is told to, and writes
/// the sample to standard output.
int run_as_child();

inline constexpr const char* child_command = "measure-one";

}  // namespace irt::contention
