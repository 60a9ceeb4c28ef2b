/// The shared objects that the tree's queues are compiled into: where they are, and how they come
/// to be there.
///
/// A queue is compiled once for each way in which tools use it, each time by itself: NAME.so is the
/// plug-in that every tool opens, and beside it lie the others (`ModuleKind`). All stand in one
/// folder of the build, with a list of those that there can be. What of them is missing or older
/// than its source is built when a tool asks for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace irt {

/// What a queue is compiled for.
enum class ModuleKind : std::uint8_t {
  plugin,         ///< NAME.so: type-erased, for tools on real threads
  contention,     ///< NAME.contention.so: as its concrete type, for `irt bench contention`
  micro,          ///< NAME.micro.so: the same for `irt bench micro`
  counted,        ///< NAME.counted.so: counts its atomic operations
  virtual_cores,  ///< NAME.virtual.so: for the checker and the simulator
};

/// The module of `kind` that lies beside the plug-in `file`, whether there is one or not.
std::filesystem::path module_beside(const std::filesystem::path& file, ModuleKind kind);

/// The queues of the tree that are compiled for `kind`, in the order of their registration. Throws
/// std::runtime_error where the build has no list of them.
const std::vector<std::string>& registered_queues(ModuleKind kind);

/// Whether `name` is one of them.
bool is_registered(std::string_view name, ModuleKind kind);

/// The module of a registered queue. Whether it is built, `build_modules` says.
std::filesystem::path module_of_tree(std::string_view name, ModuleKind kind);

/// The C symbol `name` of the shared object `file`, which stays loaded until the process ends,
/// since its code may be in use; null if it has none. Throws std::runtime_error, with the loader's
/// words, where it cannot be loaded.
const void* symbol_of(const std::filesystem::path& file, const char* name);

/// Brings the modules of those of `names` that are registered up to date. Only a program that the
/// front door has become does so, once for each module; any other takes what is there. Throws
/// std::runtime_error where one does not compile, after the compiler's words were shown.
void build_modules(std::span<const std::string> names, ModuleKind kind);

}  // namespace irt
