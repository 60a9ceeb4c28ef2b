/// Every queue by name: those built in and those of opened plug-ins.
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// The queues that were registered with `irt_add_queue()` and carry elements, in that order.
std::span<const QueueEntry> built_in_queues();

/// The registered baselines that carry none (`Claims::carries_elements`), for benchmarks alone.
std::span<const QueueEntry> built_in_counters();

/// A name or a file that the registry cannot use. `what()` is one line for the user.
class RegistryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The queues a tool can use. Not thread-safe while plug-ins are being opened.
class QueueRegistry {
 public:
  QueueRegistry();

  /// All queues that carry elements, built-in ones first. Valid until the next `open()`.
  std::span<const QueueEntry> entries() const { return entries_; }

  /// The queue `name`, or nullptr.
  const QueueEntry* find(std::string_view name) const;

  /// The queue `name`. Throws RegistryError that names the nearest one there is.
  const QueueEntry& at(std::string_view name) const;

  /// The same, baselines that only count included: for tools that do not look at elements.
  const QueueEntry& at_or_counter(std::string_view name) const;

  /// Opens a shared object that `irt_add_plugin()` built and adds its queue. The object stays
  /// loaded until the process ends, since its code may be in use. Throws RegistryError where `file`
  /// cannot be opened, is no plug-in, was built for another ABI, or brings a name already taken.
  const QueueEntry& open(const std::filesystem::path& file);

 private:
  std::vector<QueueEntry> entries_;
};

}  // namespace irt
