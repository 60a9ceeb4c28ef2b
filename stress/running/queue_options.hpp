/// The options by which a command names its queue.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

namespace irt {

/// " --queue ..." as the user gave it to the front door, which knows a header under another name
/// (IRT_QUEUES_GIVEN: a name and the options a line); else by `name` and the `plugins` there are.
template <class Plugins>
std::string queue_options(std::string_view name, const Plugins& plugins) {
  const char* given = std::getenv("IRT_QUEUES_GIVEN");  // NOLINT(concurrency-mt-unsafe)
  std::istringstream lines(given == nullptr ? "" : given);
  std::string known;
  for (std::string options; lines >> known && std::getline(lines, options);)
    if (known == name) return options;
  std::string text;
  for (const auto& plugin : plugins) text += " --plugin " + std::string(plugin);
  return text + " --queue " + std::string(name);
}

}  // namespace irt
