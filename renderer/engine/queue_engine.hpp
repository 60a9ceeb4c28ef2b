/// Render threads (Listing 3.3) and their frames (3.4), over any queue and with or without clocks.
/// The application's thread is the first of them: it has just made the rays of the first tasks, and
/// need not be woken.
///
/// The tools use `make_engine`, which runs them over the type-erased face; with the concrete type
/// of a queue they show what that face costs.
#pragma once

#include <barrier>
#include <chrono>
#include <thread>
#include <utility>

#include "renderer/engine/engine.hpp"
#include "renderer/engine/placement.hpp"
#include "renderer/engine/render_thread.hpp"

namespace irt {

/// `Queue` has push(worker, void*) and pop(worker, void*&). `measured` compiles the clocks in, and
/// `traced` the log of `EngineOptions::trace`.
template <class Queue, bool measured, bool traced = false>
class QueueEngine final : public Engine {
  static_assert(measured || !traced, "a trace is made of what the clocks say");

 public:
  /// `queue` was made for `options.threads` workers.
  QueueEngine(const EngineOptions& options, std::unique_ptr<Queue> queue,
              const Accelerator& accelerator)
      : shared_{.options = options,
                .queue = std::move(queue),
                .accelerator = accelerator,
                .pool = TaskPool(options.threads, options.rays_per_task),
                .clock_cost = measured ? clock_cost_ns() : 0},
        barrier_(options.threads) {
    workers_.reserve(options.threads);
    for (unsigned i = 0; i < options.threads; ++i) {
      workers_.push_back(std::make_unique<Worker>(shared_, i));
    }
    start_threads();
  }

  ~QueueEngine() override {
    end_ = true;
    barrier_.arrive_and_wait();  // the threads see END
  }

  FrameStats run(Application& application) override;

  [[nodiscard]] std::size_t tasks_allocated() const override { return shared_.pool.allocated(); }
  [[nodiscard]] std::size_t tasks_in_use() const override {
    return shared_.pool.in_use() - forgotten_;
  }
  [[nodiscard]] bool pinned() const override { return unpinned_ == 0; }

 private:
  using Clock = std::chrono::steady_clock;
  using Worker = RenderThread<Queue, measured, traced>;

  void start_threads();
  void thread_main(Worker& me, unsigned index);
  void collect(FrameStats& frame, Clock::time_point finished);
  void log(const Span& span) {
    if constexpr (traced) shared_.options.trace->add(workers_.size(), span);
  }

  SharedByThreads<Queue> shared_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::barrier<> barrier_;
  bool end_ = false;          // END of Listing 3.3: written before the barrier, read after it
  std::atomic<int> gate_{0};  // 1: go; -1: go home
  std::atomic<unsigned> unpinned_{0};
  std::size_t forgotten_ = 0;          // tasks lost in earlier frames
  std::vector<std::jthread> threads_;  // last: joined before anything they use goes
};

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::start_threads() {
  // Until all threads exist they wait at a gate, so that a failure half-way can send them home.
  try {
    for (unsigned i = 1; i < workers_.size(); ++i) {
      threads_.emplace_back([this, i] { thread_main(*workers_[i], i); });
    }
  } catch (...) {
    gate_ = -1;
    gate_.notify_all();
    threads_.clear();
    throw;
  }
  gate_ = 1;
  gate_.notify_all();
  if (!Pinned(shared_.options.pin, 0).holds()) ++unpinned_;
  barrier_.arrive_and_wait();  // every thread has tried to bind itself
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::thread_main(Worker& me, unsigned index) {
  const Pinned pinned(shared_.options.pin, index);
  if (!pinned.holds()) ++unpinned_;
  gate_.wait(0);
  if (gate_ < 0) return;
  const ActsFor leaves(*shared_.queue, index);
  barrier_.arrive_and_wait();
  while (true) {
    barrier_.arrive_and_wait();  // a new frame starts
    if (end_) return;
    me.work();
    barrier_.arrive_and_wait();  // all threads have finished
  }
}

template <class Queue, bool measured, bool traced>
FrameStats QueueEngine<Queue, measured, traced>::run(Application& application) {
  shared_.pool.level();
  for (auto& worker : workers_) worker->reset();
  shared_.early_end.reset();
  shared_.doubled = 0;
  shared_.application = &application;
  shared_.leaves_when_empty = shared_.options.termination == Termination::leave_when_empty;
  FrameStats frame;

  const Clock::time_point begin = Clock::now();
  TaskSink first(shared_.pool, 0, shared_.options.threads);
  try {
    application.start_frame(first);
  } catch (...) {
    first.discard();
    throw;
  }
  // Round-robin, as LOCAL wants it (7.2).
  Worker::Loop::deal(first.finish(), shared_.counts,
                     [&](std::size_t i) -> Worker& { return *workers_[i % workers_.size()]; });
  const Clock::time_point generated = Clock::now();
  shared_.frame_begin = generated;
  {
    const Pinned pinned(shared_.options.pin, 0);
    barrier_.arrive_and_wait();  // releases the other render threads
    workers_.front()->work();
    leave(*shared_.queue, 0);    // this thread may do other things than make frames
    barrier_.arrive_and_wait();  // the frame is finished
  }
  const Clock::time_point rendered = Clock::now();
  collect(frame, rendered);
  shared_.early_end.rethrow();

  const Clock::time_point collected = Clock::now();
  if (!frame.cancelled) application.finish_frame();
  using Seconds = std::chrono::duration<double>;
  frame.generate_s = Seconds(generated - begin).count();
  frame.render_s = Seconds(rendered - generated).count();
  const Clock::time_point done = Clock::now();
  frame.output_s = Seconds(done - collected).count();
  log({.begin = begin, .end = generated, .activity = Activity::generate});
  log({.begin = generated, .end = rendered, .activity = Activity::render});
  log({.begin = collected, .end = done, .activity = Activity::output});
  log({.begin = begin, .end = done, .activity = Activity::frame});
  return frame;
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::collect(FrameStats& frame, Clock::time_point finished) {
  for (auto& worker : workers_) worker->charge_barrier(finished);
  if (tasks_in_use() != 0) {
    // A queue may have answered *empty* for tasks that were not visible yet. Now they are.
    shared_.frame_begin = finished;
    shared_.leaves_when_empty = true;
    for (auto& worker : workers_) worker->work();
    leave_all(*shared_.queue, static_cast<unsigned>(workers_.size()));
  }
  frame.lost = tasks_in_use();
  forgotten_ += frame.lost;
  frame.doubled = shared_.doubled;
  frame.cancelled = shared_.early_end.is_cancelled();
  for (const auto& worker : workers_) frame.workers.push_back(worker->stats());
}

}  // namespace irt
