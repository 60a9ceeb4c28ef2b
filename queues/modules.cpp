#include "queues/modules.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <optional>
#include <set>
#include <spawn.h>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace irt {
namespace {

constexpr std::array<std::string_view, 5> suffixes{".so", ".contention.so", ".micro.so",
                                                   ".counted.so", ".virtual.so"};

std::string_view suffix_of(ModuleKind kind) {
  return suffixes.at(static_cast<std::size_t>(kind));
}

const std::filesystem::path& folder() {
  static const std::filesystem::path of_the_build = IRT_QUEUE_MODULES;
  return of_the_build;
}

/// A module's file is NAME and a suffix; names have no dots.
using Registered = std::array<std::vector<std::string>, suffixes.size()>;

Registered read_list() {
  Registered all;
  std::ifstream list(folder() / "list.txt");
  if (!list)
    throw std::runtime_error("there is no " + (folder() / "list.txt").string() +
                             ", which says what queues there are; configure the build again");
  for (std::string file; std::getline(list, file);) {
    const auto end = file.find('.');
    const auto* suffix =
        std::ranges::find(suffixes, std::string_view(file).substr(std::min(end, file.size())));
    if (suffix != suffixes.end())
      all.at(static_cast<std::size_t>(suffix - suffixes.begin())).push_back(file.substr(0, end));
  }
  return all;
}

/// The front door's script and the preset that it builds, where this program took its place: which
/// a child of this program did not.
struct FrontDoor {
  std::string preset, script;
};

std::optional<FrontDoor> front_door() {
  const char* given = std::getenv("IRT_FRONT_DOOR");  // NOLINT(concurrency-mt-unsafe)
  if (given == nullptr) return std::nullopt;
  std::istringstream words(given);
  pid_t process = 0;
  FrontDoor door;
  words >> process >> door.preset >> std::ws;
  std::getline(words, door.script);
  if (process != getpid()) return std::nullopt;
  return door;
}

int run(std::vector<std::string> command) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
    return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::filesystem::path module_beside(const std::filesystem::path& file, ModuleKind kind) {
  return std::filesystem::path(file).replace_extension(suffix_of(kind));
}

const std::vector<std::string>& registered_queues(ModuleKind kind) {
  static const Registered all = read_list();
  return all.at(static_cast<std::size_t>(kind));
}

bool is_registered(std::string_view name, ModuleKind kind) {
  return std::ranges::find(registered_queues(kind), name) != registered_queues(kind).end();
}

std::filesystem::path module_of_tree(std::string_view name, ModuleKind kind) {
  return folder() / (std::string(name) + std::string(suffix_of(kind)));
}

const void* symbol_of(const std::filesystem::path& file, const char* name) {
  // An absolute path, since a bare name would be looked up in the system's library folders.
  void* object = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw std::runtime_error(dlerror());
  return dlsym(object, name);
}

void build_modules(std::span<const std::string> names, ModuleKind kind) {
  const std::optional<FrontDoor> door = front_door();
  if (!door) return;
  static std::set<std::filesystem::path> up_to_date;
  std::vector<std::string> command{door->script, "modules", door->preset};
  for (const std::string& name : names) {
    if (!is_registered(name, kind)) continue;
    const std::filesystem::path file = module_of_tree(name, kind);
    if (up_to_date.insert(file).second) command.push_back(file);
  }
  if (command.size() > 3 && run(command) != 0)
    throw std::runtime_error("a queue of the tree does not compile, which is said above");
}

}  // namespace irt
