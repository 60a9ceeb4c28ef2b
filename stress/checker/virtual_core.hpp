/// A scenario's worker on a virtual core: the checker's counterpart of `threads/thread_core.hpp`.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "stress/checker/clock.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::checker {

/// When an operation was called and returned: events of its thread, steps of the execution.
struct CallPlace {
  stress::Kind kind = stress::Kind::push;  ///< push, pop or close
  unsigned thread = 0;
  unsigned worker = 0;
  std::size_t entry = 0;  ///< of its worker's log, which has it, or its elements, from there on
  bool finished = false;
  Clock called{};
  std::uint16_t returned = 0;
  std::size_t first_step = 0;
  std::size_t last_step = 0;
};

/// What the cores of an execution share.
struct ScenarioRun {
  const QueueEntry* entry = nullptr;
  unsigned workers = 1;
  /// Stamps are moments on a clock that all threads read in one order; else they count the calls of
  /// one execution, and only say what it did first.
  bool clocked = false;
  stress::Stamp now = 0;
  std::vector<CallPlace> calls;
  /// By producer and number of an element: events that its thread had made when it pushed that.
  std::vector<std::vector<std::uint16_t>> pushed_after;
};

/// Everything that it does, it does in the execution in progress. Other threads go on at each
/// memory event, so that `idle` has nothing to do. It may be left without being destroyed.
class VirtualCore final : public stress::Core {
 public:
  VirtualCore(stress::WorkerState& state, stress::ElementQueue& queue, ScenarioRun& run)
      : Core(state, queue), run_(run), state_(state) {}

  void idle() override {}
  stress::Stamp stamp() override;
  irt::Deadline now() override;
  std::unique_ptr<stress::ElementQueue> another_queue(unsigned workers,
                                                      std::size_t capacity) override {
    return run_.entry->make_word_queue(workers, capacity);
  }

 protected:
  stress::Stamp enter(stress::Kind kind) override;
  stress::Stamp leave() override;
  void write_payload(stress::Element e) override;
  bool sees_payload(stress::Element e) override;
  void wait_for_all() override;

 private:
  ScenarioRun& run_;
  stress::WorkerState& state_;
  std::size_t call_ = 0;
};

}  // namespace irt::checker
