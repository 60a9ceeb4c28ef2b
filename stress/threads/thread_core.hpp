/// A scenario's worker on a real thread.
#pragma once

#include <functional>
#include <memory>

#include "stress/history/clock.hpp"
#include "stress/scenarios/core.hpp"
#include "stress/threads/perturbation.hpp"
#include "stress/threads/slot.hpp"
#include "stress/threads/team.hpp"

namespace irt::stress {

/// Makes a queue of the kind under test, for so many workers and of such a capacity.
using QueueMaker = std::function<std::unique_ptr<ElementQueue>(unsigned, std::size_t)>;

class ThreadCore final : public Core {
 public:
  /// `gate` is the barrier of the run. `make` outlives it. No operation
  /// that the scenario may leave out starts after `deadline`.
  ThreadCore(WorkerState& state, ElementQueue& queue, const QueueMaker& make, Slot& slot,
             Gate& gate, const Perturbation& perturbation, std::uint64_t seed,
             Stamp deadline = never)
      : Core(state, queue),
        make_(make),
        slot_(slot),
        gate_(gate),
        disturber_(perturbation, seed),
        deadline_(deadline) {}

  /// Mostly a moment; on a busy machine, who yields comes back after everybody else's turn.
  void idle() override {
    if (++idle_ % 4 == 0) {
      std::this_thread::yield();
    } else {
      for (int left = 64; left > 0; --left) asm volatile("");
    }
  }
  Stamp stamp() override { return stamp_after(); }
  Deadline now() override { return Deadline::clock::now(); }
  std::unique_ptr<ElementQueue> another_queue(unsigned workers, std::size_t capacity) override {
    return make_(workers, capacity);
  }

 protected:
  Stamp enter(Kind kind) override {
    disturber_.edge();
    slot_.base.store(__builtin_dwarf_cfa(), std::memory_order_relaxed);  // Core's stack pointer
    slot_.doing.store(kind == Kind::push    ? Doing::push
                      : kind == Kind::leave ? Doing::leave
                                            : Doing::pop,
                      std::memory_order_relaxed);
    return stamp_before();
  }
  Stamp leave() override {
    const Stamp now = stamp_after();
    if (now > deadline_) stop_here();
    slot_.doing.store(Doing::nothing, std::memory_order_relaxed);
    // relaxed, not an increment in memory: only this thread writes
    slot_.done.store(slot_.done.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return now;
  }
  void wait_for_all() override {
    if (!gate_.pass()) complain("another worker gave up");
  }

 private:
  const QueueMaker& make_;
  Slot& slot_;
  Gate& gate_;
  Disturber disturber_;
  Stamp deadline_;
  unsigned idle_ = 0;
};

}  // namespace irt::stress
