/// Runs jobs in processes of their own: a virtual machine needs a process for itself, a host has
/// several cores, and a job that crashes or hangs takes nothing with it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace irt::many_core {

struct ChildResult {
  std::string text;     ///< what the job returned
  std::string status;   ///< "ok", "failed" (the job threw), "crashed" or "hung"
  std::string message;  ///< of what went wrong
};

/// Calls `job(i)` for every i below `count`, up to `parallel` at once, each in a child that is
/// killed after `seconds`; calls `done(i, result)` here as they end. Returns early, with the
/// children killed, when `interrupted` becomes true.
void run_in_children(std::size_t count, unsigned parallel, double seconds,
                     const std::function<std::string(std::size_t)>& job,
                     const std::function<void(std::size_t, const ChildResult&)>& done,
                     const std::atomic<bool>& interrupted);

}  // namespace irt::many_core
