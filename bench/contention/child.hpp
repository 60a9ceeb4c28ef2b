/// Each repetition in a process of its own: whatever a queue does there, the sweep goes on.
#pragma once

#include <atomic>
#include <filesystem>

#include "bench/contention/job.hpp"
#include "queues/registry.hpp"

namespace irt::contention {

/// Starts `program` with the argument `child_command`, which must call `run_as_child`, and waits
/// for its sample. A fresh program, not a copy of this one, so that the addresses of code and data
/// are drawn anew for each repetition. A child that is silent for longer than it may be is killed.
/// Where `cancel` is set meanwhile the child is killed and the sample means nothing.
///
/// Throws std::runtime_error where no process can be started.
Sample measure_in_child(const std::filesystem::path& program, const Job& job,
                        const std::atomic<bool>& cancel);

/// Reads a job from standard input, measures it, writes the sample to standard output.
int run_as_child();

inline constexpr const char* child_command = "measure-one";

}  // namespace irt::contention
