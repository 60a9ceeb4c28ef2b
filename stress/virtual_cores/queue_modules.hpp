/// Queues on virtual cores: the modules that were built of one queue each, and what is in them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::virtual_cores {

/// The queue that `module` was built of, by irt_add_queue() or irt_add_plugin(). Valid as long as
/// the module. Throws std::runtime_error where there is none, or one for another version of the
/// contract.
const QueueEntry& queue_of(const Module& module);

/// The modules there are, by the queue's name: of the queues of the tree, each built when it is
/// asked for (queues/modules.hpp), and of plug-ins.
class QueueModules {
 public:
  /// Adds the queue NAME of the plug-in `file`, which irt_add_plugin() built as NAME.so: its module
  /// lies beside it as NAME.virtual.so. Throws UsageError where there is none, or the name is
  /// taken.
  std::string add(const std::filesystem::path& file);

  /// In the order of the alphabet.
  [[nodiscard]] std::vector<std::string> names() const;

  /// Builds those of `names` that are of the tree, all at once. What is asked for one by one is
  /// built one after the other.
  void prepare(std::span<const std::string> names) const;

  /// The module of the queue `name`; nothing if there is none.
  [[nodiscard]] std::optional<std::filesystem::path> find(const std::string& name) const;

  /// The same. Throws UsageError that names the nearest one there is.
  [[nodiscard]] std::filesystem::path at(const std::string& name) const;

 private:
  std::map<std::string, std::filesystem::path> plugins_;
};

}  // namespace irt::virtual_cores
