/// A call of a queue's method, for watchdogs and interrupters to see.
#pragma once

#include "stress/threads/slot.hpp"
#include "stress/threads/standing.hpp"

namespace irt::stress {

/// The calling thread is in `method` for as long as this lives; then one operation more is done.
/// Stands in the function that makes the call.
class Call {
 public:
  // Inlined: what the queue does next must stand deeper than `Slot::base`.
  [[gnu::always_inline]] Call(Slot& slot, Doing method) : slot_(slot) {
    slot.base.store(own_stack_pointer(), std::memory_order_relaxed);
    slot.doing.store(method, std::memory_order_relaxed);
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call() {
    slot_.doing.store(Doing::nothing, std::memory_order_relaxed);
    // Not an increment in memory: only this thread writes.
    slot_.done.store(slot_.done.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

 private:
  Slot& slot_;
};

}  // namespace irt::stress
