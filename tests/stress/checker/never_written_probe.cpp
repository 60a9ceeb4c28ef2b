// tests/stress/cases/never_written.hpp on virtual cores, as GCC alone announces it.

#include "tests/stress/cases/never_written.hpp"

namespace {

constexpr irt::QueueEntry entries[] = {irt::queue_entry<irt::NeverWrittenBug>("bug"),
                                       irt::queue_entry<irt::NeverWrittenFixed>("fixed")};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries();
extern "C" const irt::QueueEntry* irt_probe_entries() {
  return entries;
}
