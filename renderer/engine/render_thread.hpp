/// A render thread of an engine: what it does with a task, and where its time goes.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "renderer/engine/early_end.hpp"
#include "renderer/engine/engine.hpp"
#include "renderer/engine/render_loop.hpp"
#include "renderer/engine/task_pool.hpp"
#include "renderer/engine/trace_and_shade.hpp"
#include "renderer/engine/trace_log.hpp"

namespace irt {

/// What the render threads of an engine share.
template <class Queue>
struct SharedByThreads {
  using Clock = std::chrono::steady_clock;

  EngineOptions options;
  std::unique_ptr<Queue> queue;
  const Accelerator& accelerator;
  TaskPool pool;
  double clock_cost = 0;  ///< in nanoseconds

  // Written before the barrier that opens a frame, read after it.
  Application* application = nullptr;
  Clock::time_point frame_begin{};
  bool leaves_when_empty = false;

  EarlyEnd early_end{options.cancel};
  TaskCounts counts{options.threads};
  alignas(128) std::atomic<std::uint64_t> doubled{0};
};

/// `Queue`, `measured` and `traced` are those of QueueEngine. No two share a cache line.
template <class Queue, bool measured, bool traced>
class alignas(128) RenderThread {
 public:
  using Clock = std::chrono::steady_clock;
  using Shared = SharedByThreads<Queue>;
  using Loop = RenderLoop<RenderThread&>;
  using Task = irt::Task;

  /// `index` is less than `shared.options.threads`; `shared` outlives the thread.
  RenderThread(Shared& shared, unsigned index)
      : shared_(shared),
        index_(index),
        answers_(shared.options.rays_per_task),
        spare_(shared.options.rays_per_task) {}

  /// Before a frame, while no thread works.
  void reset() { stats_ = {}; }

  /// Works on the frame until there is nothing left to do.
  void work() {
    if constexpr (measured) mark_ = Clock::now();
    log({.begin = shared_.frame_begin, .end = mark_, .activity = Activity::barrier});
    watch_ = {};
    Loop::work(*this);
    shared_.counts.rest(index_, true);
  }

  /// The frame ended for all at `finished`.
  void charge_barrier(Clock::time_point finished) {
    if constexpr (measured) {
      stats_.barrier_ns = nanoseconds(mark_, finished);
      log({.begin = mark_, .end = finished, .activity = Activity::barrier});
    }
  }

  /// Since `reset`.
  [[nodiscard]] const WorkerStats& stats() const { return stats_; }

 private:
  // What the loop asks for.
  friend Loop;
  Queue& queue() { return *shared_.queue; }
  [[nodiscard]] unsigned number() const { return index_; }
  std::vector<Task*>& overflow() { return overflow_; }
  TaskCounts& counts() { return shared_.counts; }
  [[nodiscard]] bool leaves_when_empty() const { return shared_.leaves_when_empty; }
  bool tasks_are_lost();
  std::vector<Task*> answer(Task& task, bool first_time);
  void hand_on(const std::vector<Task*>& children, const auto& put) {
    charge(Activity::shade, stats_.shade_ns);
    for (Task* child : children) {
      put(*child);
      charge(Activity::add, stats_.add_ns, &stats_.adds);
    }
    stats_.added += children.size();
    if constexpr (traced) {
      span_.end = mark_;
      log(span_);
    }
  }
  void got() { charge(Activity::get, stats_.get_ns, &stats_.gets); }
  void missed() {
    ++stats_.failed_gets;
    charge(Activity::idle, stats_.idle_ns);
  }
  void waited() { charge(Activity::idle, stats_.idle_ns); }
  void overflowed() { ++stats_.overflowed; }

  // Charges the time since the last call to `account`, and to `each`, and goes on from now.
  void charge(Activity activity, std::uint64_t& account, TimeHistogram* each = nullptr) {
    if constexpr (measured) {
      const Clock::time_point now = Clock::now();
      const std::uint64_t spent = nanoseconds(mark_, now);
      account += spent;
      if (each != nullptr) each->add(spent);
      log({.begin = mark_, .end = now, .activity = activity});
      mark_ = now;
    }
  }
  void log(const Span& span) {
    if constexpr (traced) shared_.options.trace->add(index_, span);
  }
  [[nodiscard]] std::uint64_t nanoseconds(Clock::time_point from, Clock::time_point to) const {
    const double raw =
        std::chrono::duration<double, std::nano>(to - from).count() - shared_.clock_cost;
    return raw > 0 ? static_cast<std::uint64_t>(raw) : 0;
  }

  // Notices that a queue has lost tasks, which would keep everyone waiting for ever: every thread
  // idle and the count unchanged at every look for two seconds. Gaps between looks count little,
  // so that a stopped process or a crowded machine is not mistaken for a fault.
  struct LossWatch {
    Clock::time_point last{};
    Clock::duration quiet{};
    std::uint64_t outstanding = 0;
  };

  Shared& shared_;
  unsigned index_;
  WorkerStats stats_;
  Clock::time_point mark_;       // end of the last interval that was accounted for
  Span span_;                    // of the task in hand
  std::vector<Task*> overflow_;  // tasks that the queue had no room for
  Answers answers_;
  Task spare_;  // holds the copy of a task that came out twice
  LossWatch watch_;
};

template <class Queue, bool measured, bool traced>
std::vector<Task*> RenderThread<Queue, measured, traced>::answer(Task& task, bool first_time) {
  if constexpr (traced) {
    // Taken down now: the task may be another's before its children are queued.
    span_ = {.begin = mark_, .end = mark_, .activity = Activity::task, .kind = task.kind};
  }
  const Task* source = &task;
  if (!first_time) {
    // The queue has handed the task out twice. It may be free or in use by now: trace a copy, so
    // that the frame shows the fault, and leave the original to its owner.
    shared_.doubled.fetch_add(1, std::memory_order_relaxed);
    spare_.kind = task.kind;
    spare_.depth = task.depth;
    spare_.sample = task.sample;
    spare_.rays.size = 0;
    for (std::uint32_t i = 0; i < task.rays.size; ++i) {
      spare_.rays.add(task.rays.ray(i), task.rays.weight(i), task.rays.pixel[i]);
    }
    source = &spare_;
  }

  TaskSink children(shared_.pool, index_);
  if (!shared_.early_end.is_here()) {
    try {
      trace_and_shade(*source, shared_.accelerator, *shared_.application, answers_, children,
                      stats_, measured ? shared_.options.profile_every : 0,
                      [&](std::uint64_t& account) { charge(Activity::trace, account); });
    } catch (...) {
      shared_.early_end.note_exception();
      children.discard();
    }
  }
  std::vector<Task*> made = std::move(children.finish());
  if (first_time) shared_.pool.recycle(index_, task);
  return made;
}

template <class Queue, bool measured, bool traced>
bool RenderThread<Queue, measured, traced>::tasks_are_lost() {
  using namespace std::chrono_literals;
  // Looks are repeated over seconds, and a wrong one only starts the watch anew.
  const bool all_idle = shared_.counts.all_rest();
  const std::uint64_t outstanding = shared_.counts.outstanding();
  const Clock::time_point now = Clock::now();
  if (all_idle && outstanding == watch_.outstanding) {
    watch_.quiet += std::min<Clock::duration>(now - watch_.last, 10ms);
  } else {
    watch_.quiet = {};
  }
  watch_.last = now;
  watch_.outstanding = outstanding;
  return watch_.quiet > 2s;
}

}  // namespace irt
