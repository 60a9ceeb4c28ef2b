// In place of counting.cpp where the objects of irt check, which count, are not built.
#include <stdexcept>

#include "bench/contention/counting.hpp"

namespace irt::contention {

std::string not_countable(const QueueRegistry& /*queues*/, std::string_view /*name*/) {
  return "this build has no irt check, whose objects count";
}

SubjectMaker counting_subject_maker(const QueueRegistry& queues, std::string_view name) {
  throw std::logic_error(std::string(name) + ": " + not_countable(queues, name));
}

AtomicEvents events_of_this_thread() {
  return {};
}

}  // namespace irt::contention
