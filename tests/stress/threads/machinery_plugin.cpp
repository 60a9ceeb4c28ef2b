// The queues of machinery.hpp in a shared object, where thread-locals go through the loader.
#include "machinery.hpp"
#include "queues/plugin.hpp"

using namespace irt;
using stress::Machinery;
using stress::Through;

extern "C" const QueueEntry* irt_machinery(Machinery machinery);
extern "C" __attribute__((visibility("default"))) const QueueEntry* irt_machinery(
    Machinery machinery) {
  static constexpr QueueEntry loader =
      queue_entry<Through<Machinery::loader>::Queue>("through-loader");
  static constexpr QueueEntry exceptions =
      queue_entry<Through<Machinery::exceptions>::Queue>("through-exceptions");
  static constexpr QueueEntry allocator =
      queue_entry<Through<Machinery::allocator>::Queue>("through-allocator");
  static constexpr QueueEntry locals =
      queue_entry<Through<Machinery::thread_local_storage>::Queue>("through-locals");
  switch (machinery) {
    case Machinery::loader:
      return &loader;
    case Machinery::exceptions:
      return &exceptions;
    case Machinery::allocator:
      return &allocator;
    default:
      return &locals;
  }
}
