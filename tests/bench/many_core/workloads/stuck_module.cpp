// Compiled for virtual cores: a queue whose pop never returns.
#include <atomic>

#include "queues/work_queue.hpp"

namespace irt {
namespace {

template <class T>
class StuckQueue {
 public:
  static constexpr std::string_view summary = "waits for what nobody does";
  static constexpr Claims claims{};

  StuckQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T /*task*/) { return true; }
  bool pop(unsigned /*worker*/, T& /*task*/) {
    while (!ready_) {
    }
    return false;
  }

 private:
  std::atomic<bool> ready_{false};
};

constexpr QueueEntry entry = queue_entry<StuckQueue>("stuck");

}  // namespace
}  // namespace irt

extern "C" const irt::QueueEntry* irt_queue_entry();
extern "C" const irt::QueueEntry* irt_queue_entry() {
  return &irt::entry;
}
