#include "stress/virtual_cores/queue_modules.hpp"

#include <algorithm>
#include <stdexcept>

#include "queues/modules.hpp"
#include "queues/nearest.hpp"
#include "queues/plugin.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::virtual_cores {

const QueueEntry& queue_of(const Module& module) {
  const auto& descriptor = *static_cast<const PluginDescriptor*>(module.find(plugin_symbol));
  if (const std::string why = mismatch(descriptor); !why.empty())
    throw std::runtime_error("module '" + module.file() + "': " + why + "; build it again");
  return descriptor.entry;
}

std::string QueueModules::add(const std::filesystem::path& file) {
  const std::filesystem::path module = module_beside(file, ModuleKind::virtual_cores);
  std::error_code error;
  if (!std::filesystem::exists(module, error))
    throw UsageError("plug-in '" + file.string() + "': there is no " + module.filename().string() +
                     " beside it, which irt_add_plugin() builds where the irt that it finds "
                     "has virtual cores; configure and build the plug-in again");
  std::string name = file.stem();
  if (is_registered(name, ModuleKind::virtual_cores) || !plugins_.emplace(name, module).second)
    throw UsageError("plug-in '" + file.string() + "': a queue named '" + name +
                     "' is there already; give the plug-in another name");
  return name;
}

std::vector<std::string> QueueModules::names() const {
  std::vector<std::string> all = registered_queues(ModuleKind::virtual_cores);
  for (const auto& [name, file] : plugins_) all.push_back(name);
  std::ranges::sort(all);
  return all;
}

void QueueModules::prepare(std::span<const std::string> names) const {
  build_modules(names, ModuleKind::virtual_cores);
}

std::optional<std::filesystem::path> QueueModules::find(const std::string& name) const {
  if (const auto plugin = plugins_.find(name); plugin != plugins_.end()) return plugin->second;
  if (!is_registered(name, ModuleKind::virtual_cores)) return {};
  prepare({&name, 1});
  return module_of_tree(name, ModuleKind::virtual_cores);
}

std::filesystem::path QueueModules::at(const std::string& name) const {
  if (auto file = find(name)) return *file;
  const std::vector<std::string> known = names();
  throw UsageError(
      unknown_name("queue", name, std::vector<std::string_view>(known.begin(), known.end())));
}

}  // namespace irt::virtual_cores
