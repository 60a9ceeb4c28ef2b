#include "renderer/engine/engine.hpp"

#include <algorithm>
#include <array>
#include <mutex>

#include "renderer/engine/queue_engine.hpp"

namespace irt {
namespace {

constexpr std::array termination_entries{
    TerminationEntry{"outstanding-count", "a thread leaves when no task is left anywhere",
                     Termination::outstanding_count},
    TerminationEntry{"leave-when-empty", "a thread leaves when it finds the queue empty (thesis)",
                     Termination::leave_when_empty},
};

/// Lets many threads use a queue that claims one at a time for an end. Blocking.
class SerialisedQueue final : public AnyWorkQueue<void*> {
 public:
  SerialisedQueue(std::unique_ptr<AnyWorkQueue<void*>> queue, const Claims& claims)
      : queue_(std::move(queue)),
        lock_pushes_(claims.one_producer()),
        lock_pops_(claims.one_consumer()) {}

  bool push(unsigned worker, void* task) override {
    std::unique_lock lock(push_mutex_, std::defer_lock);
    if (lock_pushes_) lock.lock();
    return queue_->push(worker, task);
  }

  bool pop(unsigned worker, void*& task) override {
    std::unique_lock lock(pop_mutex_, std::defer_lock);
    if (lock_pops_) lock.lock();
    return queue_->pop(worker, task);
  }

  // Says nothing about others: it may come while they push and pop.
  void leave(unsigned worker) override { queue_->leave(worker); }

 private:
  std::unique_ptr<AnyWorkQueue<void*>> queue_;
  bool lock_pushes_, lock_pops_;
  alignas(64) std::mutex push_mutex_;
  alignas(64) std::mutex pop_mutex_;
};

}  // namespace

std::span<const TerminationEntry> terminations() {
  return termination_entries;
}

std::unique_ptr<Engine> make_engine(const EngineOptions& options, const QueueEntry& entry,
                                    const Accelerator& accelerator) {
  auto queue = entry.make_task_queue(options.threads, options.queue_capacity);
  const Claims& claims = entry.claims;
  if (takes_turns(claims, options.threads)) {
    queue = std::make_unique<SerialisedQueue>(std::move(queue), claims);
  }
  if (options.trace != nullptr) {
    return std::make_unique<QueueEngine<AnyWorkQueue<void*>, true, true>>(options, std::move(queue),
                                                                          accelerator);
  }
  if (options.measure) {
    return std::make_unique<QueueEngine<AnyWorkQueue<void*>, true>>(options, std::move(queue),
                                                                    accelerator);
  }
  return std::make_unique<QueueEngine<AnyWorkQueue<void*>, false>>(options, std::move(queue),
                                                                   accelerator);
}

double clock_cost_ns() {
  // The least of several batches: whatever disturbs a batch makes it longer.
  using Clock = std::chrono::steady_clock;
  static const double cost = [] {
    constexpr int readings = 1000;
    double least = 1e9;
    for (int batch = 0; batch < 20; ++batch) {
      const Clock::time_point begin = Clock::now();
      Clock::time_point end = begin;
      for (int i = 0; i < readings; ++i) end = Clock::now();
      const std::chrono::duration<double, std::nano> spent = end - begin;
      least = std::min(least, spent.count() / readings);
    }
    return least;
  }();
  return cost;
}

WorkerStats& WorkerStats::operator+=(const WorkerStats& other) {
  tasks += other.tasks;
  for (std::size_t kind = 0; kind < task_kinds; ++kind) rays[kind] += other.rays[kind];
  added += other.added;
  overflowed += other.overflowed;
  failed_gets += other.failed_gets;
  get_ns += other.get_ns;
  add_ns += other.add_ns;
  idle_ns += other.idle_ns;
  trace_ns += other.trace_ns;
  shade_ns += other.shade_ns;
  profiled_ns += other.profiled_ns;
  barrier_ns += other.barrier_ns;
  profile.traverse_ns += other.profile.traverse_ns;
  profile.intersect_ns += other.profile.intersect_ns;
  gets += other.gets;
  adds += other.adds;
  return *this;
}

WorkerStats FrameStats::total() const {
  WorkerStats sum;
  for (const WorkerStats& worker : workers) sum += worker;
  return sum;
}

std::uint64_t FrameStats::rays() const {
  const WorkerStats sum = total();
  std::uint64_t rays = 0;
  for (const std::uint64_t of_kind : sum.rays) rays += of_kind;
  return rays;
}

double FrameStats::imbalance() const {
  std::uint64_t most = 0, all = 0;
  for (const WorkerStats& worker : workers) {
    most = std::max(most, worker.busy_ns());
    all += worker.busy_ns();
  }
  if (all == 0) return 1;
  return static_cast<double>(most) * static_cast<double>(workers.size()) / static_cast<double>(all);
}

}  // namespace irt
