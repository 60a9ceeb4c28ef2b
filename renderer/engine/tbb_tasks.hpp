/// oneTBB's task_group, as ForkedEngine wants it.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <vector>

#include "renderer/engine/task.hpp"

namespace irt {

/// An arena of `threads` slots, the caller's among them. Stealing from the oldest end of another's
/// deque, own tasks from the youngest: depth first, unlike a FIFO queue.
class TbbTasks {
 public:
  explicit TbbTasks(unsigned threads)
      : allowed_(tbb::global_control::max_allowed_parallelism, threads),
        arena_(static_cast<int>(threads)) {}
  TbbTasks(const TbbTasks&) = delete;
  TbbTasks& operator=(const TbbTasks&) = delete;
  // task_group throws where somebody has not waited for it; `run` has.
  ~TbbTasks() noexcept = default;

  template <class Process>
  void run(const std::vector<Task*>& first, Process process) {
    arena_.execute([&] {
      for (Task* task : first) spawn(*task, process);
      group_.wait();
    });
  }

  template <class Process>
  void spawn(Task& task, Process process) {
    group_.run([&task, process] {
      process(static_cast<unsigned>(tbb::this_task_arena::current_thread_index()), task);
    });
  }

 private:
  tbb::global_control allowed_;  // more threads than cores, if so asked
  tbb::task_arena arena_;
  tbb::task_group group_;
};

}  // namespace irt
