/// What a shared object shows so that a tool may use its queue.
///
/// `irt_add_plugin()` writes the source file that defines it; only who opens it needs this header.
/// The descriptor is plain data at one C symbol. A tool compares `magic`, `abi_version`, the sizes
/// and the standard library in this order and reads nothing behind them before all agree.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "queues/work_queue.hpp"

namespace irt {

/// To be raised by whoever changes `PluginDescriptor`, `QueueEntry`,
/// `Methods`, `Claims` or `AnyWorkQueue`.
inline constexpr std::uint32_t plugin_abi_version = 5;

/// "iRTqueue", read as a little-endian number.
inline constexpr std::uint64_t plugin_magic = 0x65756575'71545269U;

/// A `std::string_view` has not the same layout in every standard library.
#ifdef _LIBCPP_VERSION
inline constexpr std::array<char, 16> plugin_standard_library{"libc++"};
#else
inline constexpr std::array<char, 16> plugin_standard_library{"libstdc++"};
#endif

struct PluginDescriptor {
  std::uint64_t magic = plugin_magic;
  std::uint32_t abi_version = plugin_abi_version;
  std::uint32_t descriptor_bytes = sizeof(PluginDescriptor);
  std::uint32_t entry_bytes = sizeof(QueueEntry);
  std::uint32_t claims_bytes = sizeof(Claims);
  std::array<char, 16> standard_library = plugin_standard_library;
  QueueEntry entry;
};

/// The name of the descriptor in the shared object.
inline constexpr const char* plugin_symbol = "irt_plugin";

/// What keeps `descriptor` from being used here; empty if nothing does.
inline std::string mismatch(const PluginDescriptor& descriptor) {
  if (descriptor.magic != plugin_magic)
    return std::string("its symbol '") + plugin_symbol + "' is no iRT descriptor";
  if (descriptor.abi_version != plugin_abi_version)
    return "built for plug-in ABI " + std::to_string(descriptor.abi_version) + ", this tool has " +
           std::to_string(plugin_abi_version);
  if (descriptor.descriptor_bytes != sizeof(PluginDescriptor) ||
      descriptor.entry_bytes != sizeof(QueueEntry) || descriptor.claims_bytes != sizeof(Claims))
    return "its structures have other sizes than this tool's";
  if (descriptor.standard_library != plugin_standard_library)
    return std::string("built with another C++ standard library than ") +
           plugin_standard_library.data();
  const QueueEntry& entry = descriptor.entry;
  if (entry.name.empty() || entry.make_task_queue == nullptr || entry.make_word_queue == nullptr)
    return "its descriptor has no name or no factory";
  return {};
}

}  // namespace irt
