// A queue that calls compiled code with a state of its own, on virtual cores.

#include "tests/stress/cases/chance_elsewhere.hpp"

namespace {

constexpr irt::QueueEntry entries[] = {
    irt::queue_entry<irt::ChanceElsewhereBug>("chance-elsewhere-bug"),
};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count);
extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count) {
  *count = sizeof entries / sizeof *entries;
  return entries;
}
