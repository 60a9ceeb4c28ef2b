// Compiled for virtual cores: a queue whose pop never returns.
#include <atomic>

#include "queues/plugin.hpp"

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

}  // namespace
}  // namespace irt

extern "C" {
extern const irt::PluginDescriptor irt_plugin;
const irt::PluginDescriptor irt_plugin{.entry = irt::queue_entry<irt::StuckQueue>("stuck")};
}
