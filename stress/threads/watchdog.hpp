/// Reports where each thread stands when nothing moves any more.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "stress/threads/child.hpp"
#include "stress/threads/slot.hpp"

namespace irt::stress {

/// Watches slots from a thread of its own; also sends the progress of all to the parent.
class Watchdog {
 public:
  /// `slots` outlives it. After `patience` without a finished operation in any slot, reports a
  /// hang, with the stacks of all slots that are occupied, and ends the process; but not while a
  /// thread waits for a processor that others keep busy.
  Watchdog(std::vector<Slot>& slots, std::chrono::milliseconds patience, Messenger& messenger);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog();

  /// All operations so far.
  [[nodiscard]] std::uint64_t operations() const;

 private:
  void watch();
  /// Whether each thread that is inside an operation has waited for something or has had its share
  /// of a processor since `remember()`.
  [[nodiscard]] bool all_had_their_turn() const;
  /// Notes everybody's processor time, and ends perturbations that keep a processor from them.
  void remember();
  [[noreturn]] void report();

  std::vector<Slot>& slots_;
  std::chrono::milliseconds patience_;
  Messenger& messenger_;
  std::vector<std::uint64_t> cpu_times_;  ///< of each slot's thread, when nothing moved any more
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// How long nothing may happen before it counts as a hang.
std::chrono::milliseconds hang_patience();

}  // namespace irt::stress
