/// The engine of the thesis (3.2): symmetric render threads that take tasks from a work queue,
/// trace them, and queue what the application makes of the answers.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"
#include "renderer/bvh/accelerator.hpp"
#include "renderer/engine/application.hpp"
#include "renderer/engine/time_histogram.hpp"

namespace irt {

/// When a render thread leaves a frame.
enum class Termination : std::uint8_t {
  /// When no task is left anywhere: the tasks are counted.
  outstanding_count,
  /// As soon as it finds the queue empty (Listing 3.3). No task is lost, for who adds tasks also
  /// takes them, but threads that left early do not help with what is added later.
  leave_when_empty,
};

/// A termination policy by name, as the tools see it.
struct TerminationEntry {
  std::string_view name;
  std::string_view summary;
  Termination policy;
};

/// All policies, the default first.
std::span<const TerminationEntry> terminations();

class TraceLog;

struct EngineOptions {
  unsigned threads = 1;               ///< render threads, at least 1
  std::uint32_t rays_per_task = 256;  ///< at least 1; the thesis found 256 best (3.1)
  Termination termination = Termination::outstanding_count;
  /// Elements that a bounded queue should hold. What does not fit is kept by the worker itself.
  std::size_t queue_capacity = 1u << 16;
  bool pin = false;  ///< bind each thread to a core; needs hwloc
  /// False leaves every clock out of the render loop; all times of workers are then 0.
  bool measure = true;
  /// Every so many tasks of a worker, time traversal and intersection apart; 0: never. A profiled
  /// trace is slower, so frames whose speed counts should not be profiled.
  std::uint32_t profile_every = 0;
  /// Where to record what each thread does when: a log for so many threads, with `measure`. A work
  /// queue's engine alone can do it.
  TraceLog* trace = nullptr;
  /// If it becomes true the rest of the frame is thrown away.
  const std::atomic<bool>* cancel = nullptr;
};

/// What one render thread did in one frame. Times are in nanoseconds, clock cost taken off.
struct WorkerStats {
  std::uint64_t tasks = 0;
  std::uint64_t rays[task_kinds] = {};  ///< by TaskKind
  std::uint64_t added = 0;              ///< tasks pushed
  std::uint64_t overflowed = 0;         ///< of these, kept aside because the queue was full
  std::uint64_t failed_gets = 0;        ///< pops that found nothing
  std::uint64_t get_ns = 0;             ///< in pops that found a task
  std::uint64_t add_ns = 0;             ///< in pushes
  std::uint64_t idle_ns = 0;            ///< in pops that found nothing, and waiting between them
  std::uint64_t trace_ns = 0;           ///< traversal and intersection of unprofiled tasks
  std::uint64_t shade_ns = 0;           ///< in the application
  std::uint64_t profiled_ns = 0;        ///< traversal and intersection of profiled tasks
  std::uint64_t barrier_ns = 0;         ///< at the barrier that ends the frame
  TraceProfile profile;                 ///< of the profiled tasks
  TimeHistogram gets, adds;             ///< each pop that found a task, each push

  [[nodiscard]] std::uint64_t busy_ns() const {
    return get_ns + add_ns + trace_ns + shade_ns + profiled_ns;
  }
  WorkerStats& operator+=(const WorkerStats& other);
};

/// One frame as the thesis measures it (chapter 4). Phases in seconds.
struct FrameStats {
  double generate_s = 0;  ///< GenPrimRays, the dealing of the first tasks included
  double render_s = 0;    ///< RenderLoop, from barrier to barrier
  double output_s = 0;    ///< Output
  std::vector<WorkerStats> workers;

  bool cancelled = false;  ///< the frame is incomplete because `EngineOptions::cancel` was set
  /// Faults of the queue, 0 for a correct one: tasks that never came out, and that came out twice.
  std::uint64_t lost = 0, doubled = 0;

  [[nodiscard]] double seconds() const { return generate_s + render_s + output_s; }  ///< T.Exec
  [[nodiscard]] WorkerStats total() const;
  [[nodiscard]] std::uint64_t rays() const;  ///< of all kinds
  /// Busiest worker over the mean; 1 is perfect balance. 1 if nothing was measured.
  [[nodiscard]] double imbalance() const;
};

/// Render threads, parked between frames. Every call is made by the thread that made the engine.
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  /// Runs one frame of `application`. What the application throws in a render thread ends the frame
  /// and is thrown here; the engine then serves the next frame as before.
  virtual FrameStats run(Application& application) = 0;

  /// Tasks in memory, and those of them that are not free. Between frames none is in use, unless a
  /// queue has lost it.
  [[nodiscard]] virtual std::size_t tasks_allocated() const = 0;
  [[nodiscard]] virtual std::size_t tasks_in_use() const = 0;

  /// Whether every thread is bound to a core.
  [[nodiscard]] virtual bool pinned() const = 0;
};

/// Whether `threads` threads take turns at a queue with these claims, by a mutex at each end that
/// is for one of them. What is measured then is the queue and the mutexes.
constexpr bool takes_turns(const Claims& claims, unsigned threads) {
  return threads > 1 && (claims.one_producer() || claims.one_consumer());
}

/// An engine over the queue `queue` makes, and over `accelerator`, which outlives it. Throws
/// std::system_error if the threads cannot be started.
std::unique_ptr<Engine> make_engine(const EngineOptions& options, const QueueEntry& queue,
                                    const Accelerator& accelerator);

/// What one reading of the engine's clock costs, in nanoseconds.
double clock_cost_ns();

}  // namespace irt
