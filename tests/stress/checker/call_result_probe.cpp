// tests/stress/cases/call_result.hpp on virtual cores, as GCC alone announces it.

#include "tests/stress/cases/call_result.hpp"

namespace {

constexpr irt::QueueEntry entries[] = {irt::queue_entry<irt::CallResultBug>("bug"),
                                       irt::queue_entry<irt::CallResultFixed>("fixed")};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries();
extern "C" const irt::QueueEntry* irt_probe_entries() {
  return entries;
}
