#include "bench/contention/counting.hpp"

#include "bench/contention/subjects.hpp"
#include "bench/counted/counted_queue.hpp"

namespace irt::contention {

std::string not_countable(const QueueRegistry& queues, std::string_view name) {
  if (queues.has(name, ModuleKind::counted)) return {};
  return "there is no counting build of it: its atomic operations are compiled code or inline "
         "assembly, or its plug-in came without";
}

SubjectMaker counting_subject_maker(const QueueRegistry& queues, std::string_view name) {
  return type_erased_maker(*counted_queue(queues, name));
}

AtomicEvents events_of_this_thread() {
  return atomic_events();
}

}  // namespace irt::contention
