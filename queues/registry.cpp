#include "queues/registry.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <string>

#include "queues/nearest.hpp"
#include "queues/plugin.hpp"

namespace irt {

namespace built_in {
#define IRT_QUEUE(identifier) QueueEntry entry_of_##identifier();
#include "built_in_queues.inc"
#undef IRT_QUEUE
}  // namespace built_in

namespace {

/// Everything registered: what carries elements first.
struct Registered {
  Registered() {
    carriers = std::stable_partition(
                   entries.begin(), entries.end(),
                   [](const QueueEntry& entry) { return entry.claims.carries_elements; }) -
               entries.begin();
  }

  std::vector<QueueEntry> entries{
#define IRT_QUEUE(identifier) built_in::entry_of_##identifier(),
#include "built_in_queues.inc"
#undef IRT_QUEUE
  };
  std::ptrdiff_t carriers = 0;
};

const Registered& registered() {
  static const Registered all;
  return all;
}

const QueueEntry* find_in(std::span<const QueueEntry> entries, std::string_view name) {
  const auto found =
      std::ranges::find_if(entries, [name](const QueueEntry& entry) { return entry.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

std::span<const QueueEntry> built_in_queues() {
  return {registered().entries.begin(), registered().entries.begin() + registered().carriers};
}

std::span<const QueueEntry> built_in_counters() {
  return {registered().entries.begin() + registered().carriers, registered().entries.end()};
}

QueueRegistry::QueueRegistry() : entries_(built_in_queues().begin(), built_in_queues().end()) {}

const QueueEntry* QueueRegistry::find(std::string_view name) const {
  return find_in(entries_, name);
}

const QueueEntry& QueueRegistry::at(std::string_view name) const {
  if (const QueueEntry* entry = find(name)) return *entry;
  if (find_in(built_in_counters(), name) != nullptr)
    throw RegistryError("queue '" + std::string(name) +
                        "' only counts and carries nothing; irt bench alone can use it");
  std::vector<std::string_view> names;
  names.reserve(entries_.size());
  for (const QueueEntry& entry : entries_) names.push_back(entry.name);
  throw RegistryError(unknown_name("queue", name, names));
}

const QueueEntry& QueueRegistry::at_or_counter(std::string_view name) const {
  const QueueEntry* counter = find_in(built_in_counters(), name);
  return counter != nullptr ? *counter : at(name);
}

const QueueEntry& QueueRegistry::open(const std::filesystem::path& file) {
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
  if (!why.empty()) {
    dlclose(object);
    throw refuse(why);
  }
  const std::string_view name = descriptor->entry.name;
  if (find(name) != nullptr || find_in(built_in_counters(), name) != nullptr)
    throw RegistryError("plug-in '" + file.string() + "': a queue named '" + std::string(name) +
                        "' is there already; give the plug-in another name");
  return entries_.emplace_back(descriptor->entry);
}

}  // namespace irt
