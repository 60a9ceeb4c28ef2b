#include "stress/virtual_cores/queue_modules.hpp"

#include <dlfcn.h>
#include <stdexcept>

#include "queues/nearest.hpp"
#include "queues/plugin.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::virtual_cores {

namespace {

// Beside the runtime, wherever that was loaded from.
std::filesystem::path folder_of_the_tree() {
  Dl_info runtime{};
  if (dladdr(reinterpret_cast<const void*>(&folder_of_the_tree), &runtime) == 0) return {};
  return std::filesystem::absolute(runtime.dli_fname).parent_path() / "queues";
}

}  // namespace

const QueueEntry& queue_of(const Module& module) {
  const auto& descriptor = *static_cast<const PluginDescriptor*>(module.find(plugin_symbol));
  if (const std::string why = mismatch(descriptor); !why.empty())
    throw std::runtime_error("module '" + module.file() + "': " + why + "; build it again");
  return descriptor.entry;
}

QueueModules::QueueModules() {
  const std::filesystem::path folder = folder_of_the_tree();
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& file : std::filesystem::directory_iterator(folder))
    if (file.path().extension() == ".so") files_[file.path().stem()] = file.path();
}

std::string QueueModules::add(const std::filesystem::path& file) {
  std::filesystem::path module = file;
  module.replace_extension(".virtual.so");
  std::error_code error;
  if (!std::filesystem::exists(module, error))
    throw UsageError("plug-in '" + file.string() + "': there is no " + module.filename().string() +
                     " beside it, which irt_add_plugin() builds where the irt that it finds "
                     "has virtual cores; configure and build the plug-in again");
  std::string name = file.stem();
  if (!files_.emplace(name, module).second)
    throw UsageError("plug-in '" + file.string() + "': a queue named '" + name +
                     "' is there already; give the plug-in another name");
  return name;
}

std::vector<std::string> QueueModules::names() const {
  std::vector<std::string> all;
  all.reserve(files_.size());
  for (const auto& [name, file] : files_) all.push_back(name);
  return all;
}

const std::filesystem::path* QueueModules::find(const std::string& name) const {
  const auto found = files_.find(name);
  return found == files_.end() ? nullptr : &found->second;
}

const std::filesystem::path& QueueModules::at(const std::string& name) const {
  if (const auto* file = find(name)) return *file;
  const std::vector<std::string> known = names();
  throw UsageError(
      unknown_name("queue", name, std::vector<std::string_view>(known.begin(), known.end())));
}

}  // namespace irt::virtual_cores
