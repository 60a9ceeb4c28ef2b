// The rings of fenced_ring.hpp in a shared object, which calls ThreadSanitizer by itself.
#include "fenced_ring.hpp"

extern "C" const irt::QueueEntry* irt_fenced(bool racy);
extern "C" __attribute__((visibility("default"))) const irt::QueueEntry* irt_fenced(bool racy) {
  static constexpr irt::QueueEntry right =
      irt::queue_entry<irt::stress::Fenced<false>::Queue>("fenced");
  static constexpr irt::QueueEntry wrong =
      irt::queue_entry<irt::stress::Fenced<true>::Queue>("fenced-racy");
  return racy ? &wrong : &right;
}
