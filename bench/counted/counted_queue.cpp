#include "bench/counted/counted_queue.hpp"

#include <utility>

#include "bench/counted/atomic_events.hpp"
#include "queues/modules.hpp"
#include "queues/registry.hpp"

namespace irt {

namespace {

/// Those of plug-ins, each with its file.
std::vector<std::pair<std::string, std::filesystem::path>>& plugins() {
  static std::vector<std::pair<std::string, std::filesystem::path>> all;
  return all;
}

}  // namespace

void add_counted_plugin(const std::filesystem::path& file) {
  const auto counted = module_beside(std::filesystem::absolute(file), ModuleKind::counted);
  if (std::filesystem::exists(counted)) plugins().emplace_back(file.stem(), counted);
}

std::vector<std::string> counted_queues() {
  std::vector<std::string> names = registered_queues(ModuleKind::counted);
  for (const auto& [name, file] : plugins()) names.push_back(name);
  return names;
}

const QueueEntry* counted_queue(std::string_view name) {
  std::filesystem::path file;
  if (is_registered(name, ModuleKind::counted)) {
    const std::string own(name);
    build_modules({&own, 1}, ModuleKind::counted);
    file = module_of_tree(name, ModuleKind::counted);
  } else {
    for (const auto& [plugin, counted] : plugins())
      if (plugin == name) file = counted;
  }
  if (file.empty()) return nullptr;
  atomic_events();  // so that the linker keeps the runtime, which the object needs
  return &load_plugin(file).entry;
}

}  // namespace irt
