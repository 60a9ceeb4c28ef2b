/// The list of task systems: a new one adds its header and its line.
#include "renderer/engine/task_systems.hpp"

#include "renderer/engine/forked_engine.hpp"
#ifdef IRT_HAS_TBB
#include "renderer/engine/tbb_tasks.hpp"
#endif
#ifdef IRT_HAS_OPENMP
#include "renderer/engine/openmp_tasks.hpp"
#endif

namespace irt {
namespace {

template <class System>
std::unique_ptr<Engine> make_forked(const EngineOptions& options, const QueueEntry& /*queue*/,
                                    const Accelerator& accelerator) {
  return std::make_unique<ForkedEngine<System>>(options, accelerator);
}

constexpr TaskSystemEntry entries[] = {
    {"queue", "render threads that share a work queue (thesis 3.2)", true, make_engine},
#ifdef IRT_HAS_TBB
    {"tbb", "oneTBB's task_group: a deque per thread, and stealing", false, make_forked<TbbTasks>},
#endif
#ifdef IRT_HAS_OPENMP
    {"openmp", "OpenMP tasks, by the compiler's run-time library", false, make_forked<OpenMpTasks>},
#endif
};

}  // namespace

std::span<const TaskSystemEntry> task_systems() {
  return entries;
}

}  // namespace irt
