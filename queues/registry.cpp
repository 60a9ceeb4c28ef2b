#include "queues/registry.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <map>

#include "queues/modules.hpp"
#include "queues/nearest.hpp"

namespace irt {

namespace {

/// The entry of a registered queue; null for any other name.
const QueueEntry* of_the_tree(std::string_view name) {
  static std::map<std::string, QueueEntry, std::less<>> opened;
  if (const auto known = opened.find(name); known != opened.end()) return &known->second;
  if (!is_registered(name, ModuleKind::plugin)) return nullptr;
  const std::string own(name);
  build_modules({&own, 1}, ModuleKind::plugin);
  const QueueEntry& entry = load_plugin(module_of_tree(name, ModuleKind::plugin)).entry;
  return &opened.emplace(own, entry).first->second;
}

/// Everything registered: what carries elements first.
struct Registered {
  Registered() {
    const auto& names = registered_queues(ModuleKind::plugin);
    build_modules(names, ModuleKind::plugin);
    for (const std::string& name : names) entries.push_back(*of_the_tree(name));
    carriers = std::ranges::stable_partition(
                   entries, [](const QueueEntry& entry) { return entry.claims.carries_elements; })
                   .begin() -
               entries.begin();
  }

  std::vector<QueueEntry> entries;
  std::ptrdiff_t carriers = 0;
};

const Registered& registered() {
  static const Registered all;
  return all;
}

}  // namespace

std::span<const QueueEntry> built_in_queues() {
  return {registered().entries.begin(), registered().entries.begin() + registered().carriers};
}

std::span<const QueueEntry> built_in_counters() {
  return {registered().entries.begin() + registered().carriers, registered().entries.end()};
}

const PluginDescriptor& load_plugin(const std::filesystem::path& file) {
  const auto refuse = [&file](const std::string& why) {
    return RegistryError("plug-in '" + file.string() + "': " + why +
                         "; expected a shared object built by irt_add_plugin()");
  };
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw refuse("no such file");
  if (std::filesystem::is_directory(status)) throw refuse("is a directory");

  // An absolute path, since a bare name would be looked up in the system's library folders.
  void* object = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw refuse(dlerror());
  const auto* descriptor = static_cast<const PluginDescriptor*>(dlsym(object, plugin_symbol));
  const std::string why = descriptor == nullptr
                              ? std::string("has no symbol '") + plugin_symbol + "'"
                              : mismatch(*descriptor);
  if (why.empty()) return *descriptor;
  dlclose(object);
  throw refuse(why);
}

std::span<const QueueEntry> QueueRegistry::entries() const {
  all_.assign(built_in_queues().begin(), built_in_queues().end());
  all_.insert(all_.end(), plugins_.begin(), plugins_.end());
  return all_;
}

void QueueRegistry::prepare(std::span<const std::string> names) const {
  build_modules(names, ModuleKind::plugin);
}

const QueueEntry* QueueRegistry::find(std::string_view name) const {
  const auto plugin = std::ranges::find(plugins_, name, &QueueEntry::name);
  if (plugin != plugins_.end()) return &*plugin;
  const QueueEntry* entry = of_the_tree(name);
  return entry != nullptr && entry->claims.carries_elements ? entry : nullptr;
}

const QueueEntry& QueueRegistry::at(std::string_view name) const {
  if (const QueueEntry* entry = find(name)) return *entry;
  if (is_registered(name, ModuleKind::plugin))
    throw RegistryError("queue '" + std::string(name) +
                        "' only counts and carries nothing; irt bench alone can use it");
  const auto& tree = registered_queues(ModuleKind::plugin);
  std::vector<std::string_view> names(tree.begin(), tree.end());
  for (const QueueEntry& entry : plugins_) names.push_back(entry.name);
  throw RegistryError(unknown_name("queue", name, names));
}

const QueueEntry& QueueRegistry::at_or_counter(std::string_view name) const {
  const QueueEntry* entry = of_the_tree(name);
  return entry != nullptr ? *entry : at(name);
}

const QueueEntry& QueueRegistry::open(const std::filesystem::path& file) {
  const QueueEntry& entry = load_plugin(file).entry;
  if (is_registered(entry.name, ModuleKind::plugin) || find(entry.name) != nullptr)
    throw RegistryError("plug-in '" + file.string() + "': a queue named '" +
                        std::string(entry.name) +
                        "' is there already; give the plug-in another name");
  return plugins_.emplace_back(entry);
}

}  // namespace irt
