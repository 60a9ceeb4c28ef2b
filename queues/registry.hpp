/// Every queue by name: those of the tree and those of opened plug-ins.
#pragma once

#include <deque>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "queues/modules.hpp"
#include "queues/plugin.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The queues that were registered with `irt_add_queue()` and carry elements, in that order. Builds
/// and opens them all; who knows what it wants asks a `QueueRegistry` for that.
std::span<const QueueEntry> built_in_queues();

/// The registered baselines that carry none (`Claims::carries_elements`), for benchmarks alone.
std::span<const QueueEntry> built_in_counters();

/// A name or a file that the registry cannot use. `what()` is one line for the user.
class RegistryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The descriptor of the plug-in `file`, which stays loaded. Throws RegistryError with what keeps
/// it from being used.
const PluginDescriptor& load_plugin(const std::filesystem::path& file);

/// The queues a tool can use. One of the tree is built (modules.hpp) and opened when it is asked
/// for. Not thread-safe.
class QueueRegistry {
 public:
  /// All queues that carry elements, those of the tree first, which are all built.
  std::vector<QueueEntry> entries() const;

  /// The one that is used where none is named: the first of the tree.
  const QueueEntry& first() const;

  /// The queue `name`, or nullptr. Entries stay where they are.
  const QueueEntry* find(std::string_view name) const;

  /// The queue `name`. Throws RegistryError that names the nearest one there is.
  const QueueEntry& at(std::string_view name) const;

  /// The same, baselines that only count included: for tools that do not look at elements.
  const QueueEntry& at_or_counter(std::string_view name) const;

  /// Opens a shared object that `irt_add_plugin()` built and adds its queue. Throws RegistryError
  /// where `file` cannot be opened, is no plug-in, was built for another ABI, or brings a name
  /// already taken.
  const QueueEntry& open(const std::filesystem::path& file);

  /// The queues of opened plug-ins.
  std::vector<std::string> plugins() const;

  /// The queues that are compiled for `kind`, those of the tree first, and whether `name` is one.
  std::vector<std::string> names(ModuleKind kind) const;
  bool has(std::string_view name, ModuleKind kind) const;

  /// The file of `name`, which must be among them; of the tree it is built.
  std::filesystem::path module(std::string_view name, ModuleKind kind) const;

  /// Builds those of `names` that are of the tree, all at once. What is asked for one by one is
  /// built one after the other.
  void prepare(std::span<const std::string> names, ModuleKind kind = ModuleKind::plugin) const;

 private:
  struct Plugin {
    QueueEntry entry;
    std::filesystem::path file;
  };
  const Plugin* plugin(std::string_view name) const;

  std::deque<Plugin> plugins_;
};

}  // namespace irt
