#include "bench/contention/counting.hpp"

#include <algorithm>

#include "bench/contention/subjects.hpp"
#include "bench/counted/counted_queue.hpp"

namespace irt::contention {

void open_counting_build(const std::string& plugin) {
  add_counted_plugin(plugin);
}

std::string not_countable(std::string_view name) {
  const std::vector<std::string> names = counted_queues();
  if (std::ranges::find(names, name) != names.end()) return {};
  return "there is no counting build of it: its atomic operations are compiled code or inline "
         "assembly, or its plug-in came without";
}

SubjectMaker counting_subject_maker(std::string_view name) {
  return type_erased_maker(*counted_queue(name));
}

AtomicEvents events_of_this_thread() {
  return atomic_events();
}

}  // namespace irt::contention
