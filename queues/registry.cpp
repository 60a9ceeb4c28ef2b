#include "queues/registry.hpp"

#include <algorithm>
#include <map>

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
    // Not that of std::ranges, which clang 14 cannot compile of this library.
    carriers = std::stable_partition(
                   entries.begin(), entries.end(),
                   [](const QueueEntry& entry) { return entry.claims.carries_elements; }) -
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
  const PluginDescriptor* descriptor = nullptr;
  try {
    descriptor = static_cast<const PluginDescriptor*>(symbol_of(file, plugin_symbol));
  } catch (const std::runtime_error& failure) {
    throw refuse(failure.what());
  }
  if (descriptor == nullptr) throw refuse(std::string("has no symbol '") + plugin_symbol + "'");
  if (const std::string why = mismatch(*descriptor); !why.empty()) throw refuse(why);
  return *descriptor;
}

std::vector<QueueEntry> QueueRegistry::entries() const {
  std::vector<QueueEntry> all(built_in_queues().begin(), built_in_queues().end());
  for (const Plugin& plugin : plugins_) all.push_back(plugin.entry);
  return all;
}

const QueueEntry& QueueRegistry::first() const {
  return at(registered_queues(ModuleKind::plugin).front());
}

const QueueRegistry::Plugin* QueueRegistry::plugin(std::string_view name) const {
  const auto found =
      std::ranges::find(plugins_, name, [](const Plugin& p) { return p.entry.name; });
  return found == plugins_.end() ? nullptr : &*found;
}

const QueueEntry* QueueRegistry::find(std::string_view name) const {
  if (const Plugin* own = plugin(name)) return &own->entry;
  const QueueEntry* entry = of_the_tree(name);
  return entry != nullptr && entry->claims.carries_elements ? entry : nullptr;
}

const QueueEntry& QueueRegistry::at(std::string_view name) const {
  if (const QueueEntry* entry = find(name)) return *entry;
  if (is_registered(name, ModuleKind::plugin))
    throw RegistryError("queue '" + std::string(name) +
                        "' only counts and carries nothing; irt bench alone can use it");
  const std::vector<std::string> known = names(ModuleKind::plugin);
  throw RegistryError(
      unknown_name("queue", name, std::vector<std::string_view>(known.begin(), known.end())));
}

const QueueEntry& QueueRegistry::at_or_counter(std::string_view name) const {
  const QueueEntry* entry = of_the_tree(name);
  return entry != nullptr ? *entry : at(name);
}

const QueueEntry& QueueRegistry::open(const std::filesystem::path& file) {
  const QueueEntry& entry = load_plugin(file).entry;
  if (is_registered(entry.name, ModuleKind::plugin) || plugin(entry.name) != nullptr)
    throw RegistryError("plug-in '" + file.string() + "': a queue named '" +
                        std::string(entry.name) +
                        "' is there already; give the plug-in another name");
  plugins_.push_back({entry, std::filesystem::absolute(file)});
  return plugins_.back().entry;
}

std::vector<std::string> QueueRegistry::plugins() const {
  std::vector<std::string> all;
  for (const Plugin& plugin : plugins_) all.emplace_back(plugin.entry.name);
  return all;
}

std::vector<std::string> QueueRegistry::names(ModuleKind kind) const {
  std::vector<std::string> all = registered_queues(kind);
  for (std::string& name : plugins())
    if (has(name, kind)) all.push_back(std::move(name));
  return all;
}

bool QueueRegistry::has(std::string_view name, ModuleKind kind) const {
  const Plugin* own = plugin(name);
  return own != nullptr ? std::filesystem::exists(module_beside(own->file, kind))
                        : is_registered(name, kind);
}

std::filesystem::path QueueRegistry::module(std::string_view name, ModuleKind kind) const {
  if (const Plugin* own = plugin(name)) return module_beside(own->file, kind);
  const std::string one(name);
  prepare({&one, 1}, kind);
  return module_of_tree(name, kind);
}

void QueueRegistry::prepare(std::span<const std::string> names, ModuleKind kind) const {
  build_modules(names, kind);
}

}  // namespace irt
