#include "stress/threads/kernel_view.hpp"

#include <fmt/format.h>
#include <fstream>
#include <string>

namespace irt::stress {

std::optional<std::uint64_t> cpu_time(pid_t thread) {
  std::ifstream file(fmt::format("/proc/self/task/{}/schedstat", thread));
  std::uint64_t time = 0;
  return file >> time ? std::optional(time) : std::nullopt;
}

bool sleeps(pid_t thread) {
  std::ifstream file(fmt::format("/proc/self/task/{}/stat", thread));
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(')');
  return end != std::string::npos && end + 2 < text.size() && text[end + 2] == 'S';
}

}  // namespace irt::stress
