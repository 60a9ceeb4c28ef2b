#include "bench/counted/counted_queue.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <stdexcept>

#include "bench/counted/atomic_events.hpp"
#include "queues/plugin.hpp"

namespace irt {

std::vector<std::string> counted_queues() {
  return {
#define IRT_QUEUE(name, file) name,
#include "counted_queues.inc"
#undef IRT_QUEUE
  };
}

const QueueEntry* counted_queue(std::string_view name) {
  static constexpr struct {
    std::string_view name;
    const char* file;
  } all[] = {
#define IRT_QUEUE(name, file) {name, file},
#include "counted_queues.inc"
#undef IRT_QUEUE
  };
  const auto* found = std::find_if(std::begin(all), std::end(all),
                                   [name](const auto& one) { return one.name == name; });
  if (found == std::end(all)) return nullptr;
  atomic_events();  // so that the linker keeps the runtime, which the object needs
  void* object = dlopen(found->file, RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw std::runtime_error(dlerror());
  const auto* descriptor = static_cast<const PluginDescriptor*>(dlsym(object, plugin_symbol));
  if (descriptor == nullptr) throw std::runtime_error(dlerror());
  return &descriptor->entry;
}

}  // namespace irt
