#include "stress/checker/publication.hpp"

#include <fmt/format.h>

#include "stress/checker/execution.hpp"

namespace irt::checker {

bool sees_what_precedes(unsigned pusher, std::uint16_t called) {
  const Execution& execution = *Execution::current_execution();
  const unsigned thread = execution.state().current();
  return !execution.state().limits.races || pusher == thread ||
         execution.clock_of(thread).count[pusher] > called;
}

void report_unpublished(const std::string& element, unsigned pusher, std::uint16_t called) {
  Execution& execution = *Execution::current_execution();
  const unsigned thread = execution.state().current();
  const std::string what = fmt::format("what {} points to", element);
  execution.conclusion().report(
      FindingKind::data_race,
      fmt::format("what thread {} wrote before push {} and what thread {} read after the pop that "
                  "returned it: the queue does not publish its elements",
                  pusher, element, thread),
      {},
      {{pusher, called, nullptr, "writes " + what,
        fmt::format("races with the read of it by thread {}", thread)},
       {thread, execution.clock_of(thread).count[thread], nullptr, "reads " + what,
        fmt::format("races with the write of it by thread {}", pusher)}});
}

}  // namespace irt::checker
