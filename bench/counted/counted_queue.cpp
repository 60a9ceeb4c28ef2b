#include "bench/counted/counted_queue.hpp"

#include "bench/counted/atomic_events.hpp"

namespace irt {

const QueueEntry* counted_queue(const QueueRegistry& queues, std::string_view name) {
  if (!queues.has(name, ModuleKind::counted)) return nullptr;
  atomic_events();  // so that the linker keeps the runtime, which the object needs
  return &load_plugin(queues.module(name, ModuleKind::counted)).entry;
}

}  // namespace irt
