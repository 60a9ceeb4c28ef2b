/// The loops of Listings 3.3 and 3.4, over any queue and with or without clocks.
///
/// The tools use `make_engine`, which runs them over the type-erased face; with the concrete type
/// of a queue they show what that face costs.
#pragma once

#include <algorithm>
#include <barrier>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "renderer/engine/engine.hpp"
#include "renderer/engine/placement.hpp"
#include "renderer/engine/trace_and_shade.hpp"
#include "renderer/engine/trace_log.hpp"
#include "renderer/spin_wait.hpp"

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
      : options_(options),
        queue_(std::move(queue)),
        accelerator_(accelerator),
        pool_(options.threads, options.rays_per_task),
        barrier_(options.threads + 1),
        clock_cost_(measured ? clock_cost_ns() : 0) {
    workers_.reserve(options.threads);
    for (unsigned i = 0; i < options.threads; ++i) {
      workers_.push_back(std::make_unique<Worker>(i, options.rays_per_task));
    }
    start_threads();
  }

  ~QueueEngine() override {
    end_ = true;
    barrier_.arrive_and_wait();  // the threads see END
  }

  FrameStats run(Application& application) override;

  std::size_t tasks_allocated() const override { return pool_.allocated(); }
  std::size_t tasks_in_use() const override { return pool_.in_use() - forgotten_; }
  bool pinned() const override { return unpinned_ == 0; }

 private:
  using Clock = std::chrono::steady_clock;

  // What one render thread owns; no two share a cache line.
  struct alignas(128) Worker {
    Worker(unsigned number, std::uint32_t rays) : index(number), answers(rays), spare(rays) {}

    unsigned index;
    WorkerStats stats;
    Clock::time_point mark;       // end of the last interval that was accounted for
    std::vector<Task*> overflow;  // tasks that the queue had no room for
    Answers answers;
    Task spare;  // holds the copy of a task that came out twice
    alignas(64) std::atomic<bool> idle{false};
  };

  void start_threads();
  void thread_main(Worker& me);
  void work(Worker& me, Termination policy);
  Task* get(Worker& me);
  void put(Worker& me, Task& task);
  void process(Worker& me, Task& task);
  void answer(Worker& me, const Task& task, TaskSink& children);
  void discard(TaskSink& tasks, unsigned worker);
  void collect(FrameStats& frame, Clock::time_point finished);
  bool discarding() const {
    // Relaxed: a flag to stop early; what it protects is ordered by the barrier or the mutex.
    return failed_.load(std::memory_order_relaxed) ||
           (options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed));
  }

  // Notices that a queue has lost tasks, which would keep everyone waiting for ever: every worker
  // idle and the count unchanged at every look for two seconds. Gaps between looks count little,
  // so that a stopped process or a crowded machine is not mistaken for a fault.
  struct LossWatch {
    Clock::time_point last{};
    Clock::duration quiet{};
    std::int64_t outstanding = 0;
  };
  bool tasks_are_lost(LossWatch& watch);

  // Charges the time since the last call to `account`, and to `each`, and goes on from now.
  void charge(Worker& me, Activity activity, std::uint64_t& account,
              TimeHistogram* each = nullptr) {
    if constexpr (measured) {
      const Clock::time_point now = Clock::now();
      const std::uint64_t spent = nanoseconds(me.mark, now);
      account += spent;
      if (each != nullptr) each->add(spent);
      log(me.index, {.begin = me.mark, .end = now, .activity = activity});
      me.mark = now;
    }
  }
  void log(std::size_t row, const Span& span) {
    if constexpr (traced) options_.trace->add(row, span);
  }
  std::uint64_t nanoseconds(Clock::time_point from, Clock::time_point to) const {
    const double raw = std::chrono::duration<double, std::nano>(to - from).count() - clock_cost_;
    return raw > 0 ? static_cast<std::uint64_t>(raw) : 0;
  }

  EngineOptions options_;
  std::unique_ptr<Queue> queue_;
  const Accelerator& accelerator_;
  TaskPool pool_;
  Application* application_ = nullptr;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::barrier<> barrier_;
  double clock_cost_;
  Clock::time_point frame_begin_;  // as end_: written before the barrier, read after it
  bool end_ = false;               // END of Listing 3.3: written before the barrier, read after it
  std::atomic<int> gate_{0};       // 1: go; -1: go home
  std::atomic<unsigned> unpinned_{0};
  std::size_t forgotten_ = 0;  // tasks lost in earlier frames
  std::mutex error_mutex_;
  std::exception_ptr error_;
  std::atomic<bool> failed_{false};
  alignas(128) std::atomic<std::int64_t> outstanding_{0};
  alignas(128) std::atomic<std::uint64_t> doubled_{0};
  std::vector<std::jthread> threads_;  // last: joined before anything they use goes
};

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::start_threads() {
  // Until all threads exist they wait at a gate, so that a failure half-way can send them home.
  try {
    for (auto& worker : workers_) {
      threads_.emplace_back([this, me = worker.get()] { thread_main(*me); });
    }
  } catch (...) {
    gate_ = -1;
    gate_.notify_all();
    threads_.clear();
    throw;
  }
  gate_ = 1;
  gate_.notify_all();
  barrier_.arrive_and_wait();  // every thread has tried to bind itself
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::thread_main(Worker& me) {
  if (!options_.pin || !pin_this_thread(me.index)) ++unpinned_;
  gate_.wait(0);
  if (gate_ < 0) return;
  barrier_.arrive_and_wait();
  while (true) {
    barrier_.arrive_and_wait();  // a new frame starts
    if (end_) return;
    work(me, options_.termination);
    barrier_.arrive_and_wait();  // all threads have finished
  }
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::work(Worker& me, Termination policy) {
  if constexpr (measured) me.mark = Clock::now();
  log(me.index, {.begin = frame_begin_, .end = me.mark, .activity = Activity::barrier});
  SpinWait wait;
  LossWatch watch;
  std::uint32_t misses = 0;
  while (true) {
    if (Task* task = get(me)) {
      charge(me, Activity::get, me.stats.get_ns, &me.stats.gets);
      if (misses != 0) {
        misses = 0;
        wait.reset();
        me.idle.store(false, std::memory_order_relaxed);  // only the loss watch looks, and twice
      }
      process(me, *task);
      continue;
    }
    ++me.stats.failed_gets;
    charge(me, Activity::idle, me.stats.idle_ns);
    if (policy == Termination::leave_when_empty) break;
    // Relaxed: a task is counted before it is queued and discounted after its children are counted,
    // so in the modification order of the count 0 comes once, after the last task; the store that
    // opened the frame is ordered before by the barrier. What the tasks wrote is published by the
    // barrier, not by the count.
    if (outstanding_.load(std::memory_order_relaxed) == 0) break;
    if (misses++ == 0) me.idle.store(true, std::memory_order_relaxed);
    if (misses % 1024 == 0 && tasks_are_lost(watch)) break;
    wait();
    charge(me, Activity::idle, me.stats.idle_ns);
  }
  me.idle.store(true, std::memory_order_relaxed);
}

template <class Queue, bool measured, bool traced>
Task* QueueEngine<Queue, measured, traced>::get(Worker& me) {
  void* task = nullptr;
  if (queue_->pop(me.index, task)) return static_cast<Task*>(task);
  if (me.overflow.empty()) return nullptr;
  Task* kept = me.overflow.back();
  me.overflow.pop_back();
  return kept;
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::put(Worker& me, Task& task) {
  task.queued.store(true, std::memory_order_relaxed);  // published by the push, with the rays
  if (queue_->push(me.index, &task)) return;
  me.overflow.push_back(&task);
  ++me.stats.overflowed;
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::process(Worker& me, Task& task) {
  const Clock::time_point taken = me.mark;
  const TaskKind kind = task.kind;  // it may be another's before this one is done
  // Relaxed: of two takers exactly one finds true, by atomicity alone.
  const bool first_time = task.queued.exchange(false, std::memory_order_relaxed);
  const Task* source = &task;
  if (!first_time) {
    // The queue has handed the task out twice. It may be free or in use by now: trace a copy, so
    // that the frame shows the fault, and leave the original to its owner.
    doubled_.fetch_add(1, std::memory_order_relaxed);
    me.spare.kind = task.kind;
    me.spare.depth = task.depth;
    me.spare.sample = task.sample;
    me.spare.rays.size = 0;
    for (std::uint32_t i = 0; i < task.rays.size; ++i) {
      me.spare.rays.add(task.rays.ray(i), task.rays.weight(i), task.rays.pixel[i]);
    }
    source = &me.spare;
  }

  TaskSink children(pool_, me.index);
  if (!discarding()) {
    try {
      answer(me, *source, children);
    } catch (...) {
      const std::scoped_lock lock(error_mutex_);
      if (!error_) error_ = std::current_exception();
      failed_.store(true, std::memory_order_relaxed);
      discard(children, me.index);
    }
  }
  const std::vector<Task*>& made = children.finish();
  if (first_time) pool_.recycle(me.index, task);

  // One step for the task that is done and the ones it made; see `work` for the order.
  const std::int64_t change = static_cast<std::int64_t>(made.size()) - (first_time ? 1 : 0);
  if (change != 0) outstanding_.fetch_add(change, std::memory_order_relaxed);
  charge(me, Activity::shade, me.stats.shade_ns);
  for (Task* child : made) {
    put(me, *child);
    charge(me, Activity::add, me.stats.add_ns, &me.stats.adds);
  }
  me.stats.added += made.size();
  log(me.index, {.begin = taken, .end = me.mark, .activity = Activity::task, .kind = kind});
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::answer(Worker& me, const Task& task,
                                                  TaskSink& children) {
  ++me.stats.tasks;
  me.stats.rays[static_cast<std::size_t>(task.kind)] += task.rays.size;
  TraceProfile* profile = nullptr;
  if constexpr (measured) {
    if (options_.profile_every != 0 && me.stats.tasks % options_.profile_every == 0) {
      profile = &me.stats.profile;
    }
  }
  std::uint64_t& trace_time = profile != nullptr ? me.stats.profiled_ns : me.stats.trace_ns;
  trace_and_shade(task, accelerator_, *application_, me.answers, children, profile,
                  [&] { charge(me, Activity::trace, trace_time); });
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::discard(TaskSink& tasks, unsigned worker) {
  std::vector<Task*>& made = tasks.finish();
  for (Task* task : made) pool_.recycle(worker, *task);
  made.clear();
}

template <class Queue, bool measured, bool traced>
bool QueueEngine<Queue, measured, traced>::tasks_are_lost(LossWatch& watch) {
  using namespace std::chrono_literals;
  // Relaxed: looks are repeated over seconds, and a wrong one only starts the watch anew.
  bool all_idle = true;
  for (const auto& worker : workers_) all_idle &= worker->idle.load(std::memory_order_relaxed);
  const std::int64_t outstanding = outstanding_.load(std::memory_order_relaxed);
  const Clock::time_point now = Clock::now();
  if (all_idle && outstanding == watch.outstanding) {
    watch.quiet += std::min<Clock::duration>(now - watch.last, 10ms);
  } else {
    watch.quiet = {};
  }
  watch.last = now;
  watch.outstanding = outstanding;
  return watch.quiet > 2s;
}

template <class Queue, bool measured, bool traced>
FrameStats QueueEngine<Queue, measured, traced>::run(Application& application) {
  pool_.level();
  for (auto& worker : workers_) worker->stats = {};
  error_ = nullptr;
  failed_ = false;
  doubled_ = 0;
  application_ = &application;
  FrameStats frame;

  const Clock::time_point begin = Clock::now();
  TaskSink first(pool_, 0, options_.threads);
  try {
    application.start_frame(first);
  } catch (...) {
    discard(first, 0);
    throw;
  }
  const std::vector<Task*>& tasks = first.finish();
  outstanding_ = static_cast<std::int64_t>(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    put(*workers_[i % workers_.size()], *tasks[i]);  // round-robin, as LOCAL wants it (7.2)
  }
  const Clock::time_point generated = Clock::now();
  frame_begin_ = generated;
  barrier_.arrive_and_wait();  // releases the render threads
  barrier_.arrive_and_wait();  // the frame is finished
  const Clock::time_point rendered = Clock::now();
  collect(frame, rendered);
  if (error_) std::rethrow_exception(error_);

  const Clock::time_point collected = Clock::now();
  if (!frame.cancelled) application.finish_frame();
  using Seconds = std::chrono::duration<double>;
  frame.generate_s = Seconds(generated - begin).count();
  frame.render_s = Seconds(rendered - generated).count();
  const Clock::time_point done = Clock::now();
  frame.output_s = Seconds(done - collected).count();
  const std::size_t row = workers_.size();
  log(row, {.begin = begin, .end = generated, .activity = Activity::generate});
  log(row, {.begin = generated, .end = rendered, .activity = Activity::render});
  log(row, {.begin = collected, .end = done, .activity = Activity::output});
  log(row, {.begin = begin, .end = done, .activity = Activity::frame});
  return frame;
}

template <class Queue, bool measured, bool traced>
void QueueEngine<Queue, measured, traced>::collect(FrameStats& frame, Clock::time_point finished) {
  if constexpr (measured) {
    for (auto& worker : workers_) {
      worker->stats.barrier_ns = nanoseconds(worker->mark, finished);
      log(worker->index, {.begin = worker->mark, .end = finished, .activity = Activity::barrier});
    }
  }
  if (tasks_in_use() != 0) {
    // A queue may have answered *empty* for tasks that were not visible yet. Now they are.
    frame_begin_ = finished;
    for (auto& worker : workers_) work(*worker, Termination::leave_when_empty);
  }
  frame.lost = tasks_in_use();
  forgotten_ += frame.lost;
  frame.doubled = doubled_;
  frame.cancelled = options_.cancel != nullptr && *options_.cancel;
  for (const auto& worker : workers_) frame.workers.push_back(worker->stats);
}

}  // namespace irt
