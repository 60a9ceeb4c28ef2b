/// OpenMP's tasks, as ForkedEngine wants them.
#pragma once

#include <omp.h>
#include <vector>

#include "renderer/engine/task.hpp"

namespace irt {

/// One parallel region per frame; the barrier at its end waits for all tasks.
class OpenMpTasks {
 public:
  explicit OpenMpTasks(unsigned threads) : threads_(static_cast<int>(threads)) {}

  template <class Process>
  void run(const std::vector<Task*>& first, Process process) {
#pragma omp parallel num_threads(threads_)
#pragma omp single
    for (Task* task : first) spawn(*task, process);
  }

  template <class Process>
  void spawn(Task& task, Process process) {
    Task* const next = &task;
#pragma omp task firstprivate(next, process)
    process(static_cast<unsigned>(omp_get_thread_num()), *next);
  }

 private:
  int threads_;
};

}  // namespace irt
