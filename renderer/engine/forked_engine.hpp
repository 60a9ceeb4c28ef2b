/// Frames on a task system of somebody else, in place of a work queue.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "renderer/engine/early_end.hpp"
#include "renderer/engine/engine.hpp"
#include "renderer/engine/task_pool.hpp"
#include "renderer/engine/trace_and_shade.hpp"

namespace irt {

/// Tasks, memory, tracing and shading are those of the queue-driven engine; threads and schedule
/// are the system's. `System` has
///
///     explicit System(unsigned threads);
///     template <class Process> void run(const std::vector<Task*>& first, Process process);
///     template <class Process> void spawn(Task& task, Process process);
///
/// `run` returns when every first task and every spawned one has been given to
/// `process(worker, task)` once, `worker` being less than `threads` and in use by one thread at a
/// time. `process` calls `spawn`.
///
/// When a task is taken out cannot be seen from here, so there are no times of gets and adds: what
/// a worker does not spend on tracing and shading counts as idle.
template <class System>
class ForkedEngine final : public Engine {
 public:
  ForkedEngine(const EngineOptions& options, const Accelerator& accelerator)
      : options_(options),
        accelerator_(accelerator),
        pool_(options.threads, options.rays_per_task),
        system_(options.threads),
        early_end_(options.cancel) {
    for (unsigned i = 0; i < options.threads; ++i) {
      workers_.push_back(std::make_unique<Worker>(options.rays_per_task));
    }
  }

  FrameStats run(Application& application) override;
  [[nodiscard]] std::size_t tasks_allocated() const override { return pool_.allocated(); }
  [[nodiscard]] std::size_t tasks_in_use() const override { return pool_.in_use(); }
  [[nodiscard]] bool pinned() const override { return false; }

 private:
  using Clock = std::chrono::steady_clock;

  // No two share a cache line.
  struct alignas(128) Worker {
    explicit Worker(std::uint32_t rays) : answers(rays) {}

    WorkerStats stats;
    Clock::time_point mark;
    Answers answers;
    bool inside = false;
    std::vector<Task*> kept;  // came while `inside`
  };

  void process(unsigned index, Task& task);
  void work_on(Worker& me, unsigned index, Task& task);
  void collect(FrameStats& frame);
  void charge(Worker& me, std::uint64_t& account) const {
    if (!options_.measure) return;
    const Clock::time_point now = Clock::now();
    account += static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(now - me.mark).count());
    me.mark = now;
  }

  EngineOptions options_;
  const Accelerator& accelerator_;
  TaskPool pool_;
  System system_;
  Application* application_ = nullptr;
  std::vector<std::unique_ptr<Worker>> workers_;
  EarlyEnd early_end_;
};

template <class System>
void ForkedEngine<System>::process(unsigned index, Task& task) {
  // A system may run a task within the one that spawns it. Then it waits for that one to end, so
  // that a long line of descendants needs no deep stack.
  Worker& me = *workers_[index];
  if (me.inside) {
    me.kept.push_back(&task);
    return;
  }
  me.inside = true;
  work_on(me, index, task);
  while (!me.kept.empty()) {
    Task& next = *me.kept.back();
    me.kept.pop_back();
    work_on(me, index, next);
  }
  me.inside = false;
}

template <class System>
void ForkedEngine<System>::work_on(Worker& me, unsigned index, Task& task) {
  if (options_.measure) me.mark = Clock::now();
  TaskSink children(pool_, index);
  if (!early_end_.is_here()) {
    try {
      trace_and_shade(task, accelerator_, *application_, me.answers, children, me.stats,
                      options_.measure ? options_.profile_every : 0,
                      [&](std::uint64_t& account) { charge(me, account); });
    } catch (...) {
      early_end_.note_exception();
      children.discard();
    }
    charge(me, me.stats.shade_ns);
  }
  pool_.recycle(index, task);
  me.stats.added += children.finish().size();
  for (Task* child : children.finish()) {
    system_.spawn(*child, [this](unsigned worker, Task& next) { process(worker, next); });
  }
}

template <class System>
FrameStats ForkedEngine<System>::run(Application& application) {
  pool_.level();
  for (auto& worker : workers_) worker->stats = {};
  early_end_.reset();
  application_ = &application;

  const Clock::time_point begin = Clock::now();
  TaskSink first(pool_, 0, options_.threads);
  try {
    application.start_frame(first);
  } catch (...) {
    first.discard();
    throw;
  }
  const std::vector<Task*>& tasks = first.finish();
  const Clock::time_point generated = Clock::now();
  system_.run(tasks, [this](unsigned worker, Task& task) { process(worker, task); });
  const Clock::time_point rendered = Clock::now();
  using Seconds = std::chrono::duration<double>;
  FrameStats frame;
  frame.generate_s = Seconds(generated - begin).count();
  frame.render_s = Seconds(rendered - generated).count();
  collect(frame);
  early_end_.rethrow();

  const Clock::time_point collected = Clock::now();
  if (!frame.cancelled) application.finish_frame();
  frame.output_s = Seconds(Clock::now() - collected).count();
  return frame;
}

template <class System>
void ForkedEngine<System>::collect(FrameStats& frame) {
  const auto all = static_cast<std::uint64_t>(frame.render_s * 1e9);
  for (auto& worker : workers_) {
    const std::uint64_t busy = worker->stats.busy_ns();
    if (options_.measure && all > busy) worker->stats.idle_ns = all - busy;
    frame.workers.push_back(worker->stats);
  }
  frame.lost = pool_.in_use();
  frame.cancelled = early_end_.is_cancelled();
}

}  // namespace irt
