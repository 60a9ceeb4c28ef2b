#include "bench/counted/counted_queue.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <stdexcept>
#include <utility>

#include "bench/counted/atomic_events.hpp"
#include "queues/plugin.hpp"

namespace irt {

namespace {

// Each with its file.
std::vector<std::pair<std::string, std::string>>& all_queues() {
  static std::vector<std::pair<std::string, std::string>> all{
#define IRT_QUEUE(name, file) {name, file},
#include "counted_queues.inc"
#undef IRT_QUEUE
  };
  return all;
}

}  // namespace

void add_counted_plugin(const std::filesystem::path& file) {
  std::filesystem::path counted = std::filesystem::absolute(file);
  counted.replace_extension(".counted.so");
  if (std::filesystem::exists(counted)) all_queues().emplace_back(file.stem(), counted);
}

std::vector<std::string> counted_queues() {
  std::vector<std::string> names;
  for (const auto& [name, file] : all_queues()) names.push_back(name);
  return names;
}

const QueueEntry* counted_queue(std::string_view name) {
  const auto& all = all_queues();
  const auto found =
      std::ranges::find_if(all, [name](const auto& one) { return one.first == name; });
  if (found == all.end()) return nullptr;
  atomic_events();  // so that the linker keeps the runtime, which the object needs
  void* object = dlopen(found->second.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw std::runtime_error(dlerror());
  const auto* descriptor = static_cast<const PluginDescriptor*>(dlsym(object, plugin_symbol));
  if (descriptor == nullptr) throw std::runtime_error(dlerror());
  if (const std::string why = mismatch(*descriptor); !why.empty())
    throw std::runtime_error("plug-in '" + found->second + "': " + why + "; build it again");
  return &descriptor->entry;
}

}  // namespace irt
