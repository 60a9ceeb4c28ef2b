/// A plug-in with one thing wrong; BAD says which.
#include "queues/blocking/mutex_queue.hpp"
#include "queues/plugin.hpp"

namespace {

enum class Bad {
  without_symbol,
  other_magic,
  other_abi,
  other_sizes,
  other_library,
  no_factory,
  name_taken
};

[[maybe_unused]] constexpr char letter = 'q';

[[maybe_unused]] irt::PluginDescriptor descriptor(Bad bad) {
  irt::PluginDescriptor plugin{.entry = irt::queue_entry<irt::MutexQueue>("bad")};
  if (bad == Bad::other_magic) plugin.magic ^= 1;
  if (bad == Bad::other_abi) plugin.abi_version = 999;
  if (bad == Bad::other_sizes) plugin.entry_bytes += 8;
  if (bad == Bad::other_library) plugin.standard_library = {"other"};
  if (bad == Bad::no_factory) plugin.entry.make_task_queue = nullptr;
  if (bad == Bad::name_taken) plugin.entry.name = "mutex";
  // A stale plug-in has anything behind the head: who looks there too early crashes.
  if (bad == Bad::other_magic || bad == Bad::other_abi || bad == Bad::other_sizes)
    plugin.entry.name = {&letter, 100'000};
  return plugin;
}

}  // namespace

#ifdef BAD
extern "C" {
extern const irt::PluginDescriptor irt_plugin;
const irt::PluginDescriptor irt_plugin = descriptor(Bad::BAD);
}
#endif
